// `cartvo calibrate check`: tests whether a rig file matches given pictures.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/format/rig_formats.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "capture/dataset/image_files.hpp"
#include "common/command_line/parser.hpp"
#include "tools/calibrate/check/row_check.hpp"
#include "tools/calibrate/source_pairs.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path rig, source, right;
  int pairs = 20;
  double largest_rms = 0.3;
  bool json = false;
};

/// Opens a source; pictures need no instants here, where their names tell the pairs.
capture::StereoSource openPairs(const fs::path& path) {
  try {
    return capture::openSource(path);
  } catch (const std::runtime_error&) {
    using enum capture::FolderLayout;
    const std::optional<capture::FolderLayout> layout = capture::detectImageFolder(path);
    if (layout != kitti && layout != one_folder) throw;
    capture::SourceSettings any_rate;
    any_rate.frame_rate = 1.0;
    return capture::openSource(path, any_rate);
  }
}

using UsePair = std::function<void(const cv::Mat& left, const cv::Mat& right)>;

/// Calls `use` for pairs spread evenly over the source.
void forSelectedPairs(const Options& options, const UsePair& use) {
  if (!options.right.empty()) {
    const capture::GreyLevels levels = capture::measureGreyLevels({options.source}, {options.right});
    use(capture::readGreyImage(options.source, levels.left),
        capture::readGreyImage(options.right, levels.right));
    return;
  }
  capture::StereoSource source = openPairs(options.source);
  const std::size_t stride = std::max<std::size_t>(1, source.pairs / static_cast<std::size_t>(options.pairs));
  ProgressBar progress("pairs");
  std::size_t index = 0, used = 0;
  calibrate::forEachPair(source, [&](const capture::FramePair& pair) {
    if (index++ % stride != 0) return true;
    use(pair.left.image, pair.right.image);
    progress.show(++used, static_cast<std::size_t>(options.pairs));
    return used < static_cast<std::size_t>(options.pairs);
  });
}

/// The rig; the size of the images is for files that do not contain it, such as KITTI's calib.txt.
calib::Rig readRigOf(const Options& options) {
  calib::RigReading reading;
  if (!options.right.empty()) {
    reading.image_size = capture::readGreyImage(options.source).size();
  } else {
    const capture::StereoSource source = openPairs(options.source);
    reading.cameras = source.cameras;
    if (!source.first_image.empty()) reading.image_size = capture::readGreyImage(source.first_image).size();
  }
  return calib::readRigFiles({options.rig}, reading);
}

/// Matches of the pairs in rectified images, with left and right exchanged or not.
struct Matches {
  std::vector<calibrate::RectifiedMatch> points;
  calibrate::Contradictions contradictions;
  int pairs = 0;
  int of_one_camera = 0;  ///< of the pairs
};

Matches matchPairs(const Options& options, const calib::Rectifier& rectifier, bool exchanged) {
  Matches matches;
  forSelectedPairs(options, [&](const cv::Mat& left, const cv::Mat& right) {
    cv::Mat rectified_left, rectified_right;
    rectifier.rectifyLeft(exchanged ? right : left, rectified_left);
    rectifier.rectifyRight(exchanged ? left : right, rectified_right);
    const auto points = calibrate::matchRectified(rectified_left, rectified_right);
    matches.points.insert(matches.points.end(), points.begin(), points.end());
    calibrate::addContradictions(rectified_left, rectified_right, points, options.largest_rms,
                                 matches.contradictions);
    ++matches.pairs;
    if (calibrate::areOfOneCamera(left, right)) ++matches.of_one_camera;
  });
  return matches;
}

/// The check with exchanged images; nothing if they show too few common points.
std::optional<calibrate::RowCheck> checkExchanged(const Options& options, const calib::Rectifier& rectifier) {
  const Matches matches = matchPairs(options, rectifier, true);
  try {
    return calibrate::checkRows(matches.points, matches.pairs, rectifier.rectification());
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

void run(const Options& options) {
  const calib::Rig rig = readRigOf(options);
  const calib::Rectifier rectifier(rig, rig.rectification, calib::buildTables(rig, rig.rectification));
  const calib::Rectification& rectification = rectifier.rectification();
  const Matches matches = matchPairs(options, rectifier, false);
  if (matches.of_one_camera > 0) {
    throw std::runtime_error(
        "the left and the right picture of " + std::to_string(matches.of_one_camera) + " of " +
        std::to_string(matches.pairs) +
        " pairs are the same: they are of one camera; give the pictures of the left and the right camera");
  }
  calibrate::RowChecks checks{
      calibrate::checkRows(matches.points, matches.pairs, rectification), {}, matches.contradictions};
  const bool passes = calibrate::passes(checks.check, options.largest_rms);
  if (!passes && !checks.cannotTell(options.largest_rms))
    checks.exchanged = checkExchanged(options, rectifier);
  const std::string report =
      options.json ? jsonText(calibrate::rowCheckJson(checks, rectification, options.largest_rms))
                   : calibrate::rowCheckText(checks, rectification, options.largest_rms);
  std::fputs(report.c_str(), stdout);
  if (!passes) throw ExitCode(EXIT_FAILURE);
}

}  // namespace

void addCalibrateCheck(Command calibrate) {
  const Command command = calibrate.addSubcommand("check", "Test a rig file on pictures");
  const auto options = std::make_shared<Options>();
  command.addOption("RIG", options->rig, "Rig file: cartvo's own, OpenCV's, Kalibr's, MATLAB's or KITTI's")
      .required();
  command
      .addOption("SOURCE", options->source,
                 "A recording, a folder in KITTI's or EuRoC's layout, or the left picture")
      .required();
  command.addOption("RIGHT", options->right, "The right picture");
  command.addOption("--pairs", options->pairs, "Number of pairs to test, spread over SOURCE")
      .range(1, 100000)
      .captureDefault();
  command
      .addOption("--largest-rms", options->largest_rms,
                 "Largest RMS of the vertical disparity that passes, px")
      .range(0.01, 100.0)
      .captureDefault();
  command.addFlag("--json", options->json, "Report as JSON");
  command.footer(
      "The exit code is 0 if the rig passes and 1 if not, or if the pictures cannot tell. The cart must be "
      "at "
      "a\n"
      "standstill if the cameras are not synchronised.\n"
      "Examples:\n"
      "  cartvo calibrate check rig.yaml left.png right.png\n"
      "  cartvo calibrate check camchain.yaml euroc/V1_01_easy --pairs 50");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
