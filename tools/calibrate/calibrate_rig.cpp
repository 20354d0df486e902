// `cartvo calibrate SOURCE`: calibrates both cameras and their relative pose from views of a board.
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calib/format/rig_file.hpp"
#include "calib/model/rig_validation.hpp"
#include "calib/solver/calibration.hpp"
#include "capture/dataset/image_files.hpp"
#include "capture/recording/recording_folder.hpp"
#include "capture/recording/recording_source.hpp"
#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "daemon/service/configuration.hpp"
#include "daemon/service/live_camera.hpp"
#include "tools/calibrate/next_step.hpp"
#include "tools/calibrate/report/calibration_report.hpp"
#include "tools/calibrate/report/calibration_summary.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/calibrate/views/board_views.hpp"
#include "tools/calibrate/views/kept_views.hpp"
#include "tools/calibrate/views/live_page.hpp"
#include "tools/calibrate/views/newest_frame.hpp"
#include "tools/calibrate/views/stream_views.hpp"
#include "tools/calibrate/views/view_guide.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/report/html.hpp"

namespace cartvo {
namespace {

struct Options {
  std::filesystem::path source;
  std::string left, right;
  std::filesystem::path configuration = "/etc/cartvo/cartvod.yaml";
  std::string board;
  std::filesystem::path output;
  std::filesystem::path report;
  std::string model = "auto";
  double free_scaling = 0.0;
  bool json = false;
  bool unusual_geometry = false;
  std::optional<ListenAddress> page;
};

volatile std::sig_atomic_t stop_requested = 0;

/// The first Ctrl-C ends the collection of views, the second one the program.
void stopOnFirstInterrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

const std::map<std::string, std::vector<calib::CalibrationModel>>& modelChoices() {
  using enum calib::CalibrationModel;
  static const std::map<std::string, std::vector<calib::CalibrationModel>> choices{
      {"auto", {brown2, brown4, brown5, brown8, wide}},
      {"brown", {brown2, brown4, brown5, brown8}},
      {"brown2", {brown2}},
      {"brown4", {brown4}},
      {"brown5", {brown5}},
      {"brown8", {brown8}},
      {"wide", {wide}}};
  return choices;
}

ImagePairs findPairs(const Options& options) {
  if (options.left.empty()) return pairsInFolder(options.source);
  return pairsByPattern(options.source / options.left, options.source / options.right);
}

/// The rig file that the output will replace, if any. Throws if the output exists but is no rig file, before
/// any work is done.
std::optional<calib::Rig> rigBefore(const std::filesystem::path& output) {
  if (!std::filesystem::exists(output)) return std::nullopt;
  try {
    return calib::readRig(output);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string("--output exists and is not a rig file, so it is not replaced: ") +
                             error.what());
  }
}

/// The calibrated rig, with the name, the mounting, the readouts and the masks of the rig file that it
/// replaces. Throws std::runtime_error if its geometry is unusual and --unusual-geometry was not given.
calib::Rig rigToWrite(const calib::Calibration& calibration, const std::optional<calib::Rig>& before,
                      const Options& options) {
  calib::Rig rig = calibration.rig();
  rig.name = before ? before->name : options.output.stem().string();
  rig.T_body_camera = before ? before->T_body_camera : calib::forwardLookingMount();
  if (before) {
    rig.left.readout = before->left.readout;
    rig.right.readout = before->right.readout;
    if (before->left.size == rig.left.size) {
      rig.left.mask = before->left.mask;
      rig.right.mask = before->right.mask;
    }
  }
  rig.rectification.free_scaling = options.free_scaling;
  rig.scale_stddev = calib::scaleStddev(calibration);
  const std::string finding = calib::unusualGeometry(rig);
  rig.unusual_geometry = !finding.empty();
  if (rig.unusual_geometry && !options.unusual_geometry) {
    throw std::runtime_error("the calibrated rig is unusual: " + finding +
                             " If it is really so, add "
                             "--unusual-geometry; " +
                             options.output.string() + " is not changed");
  }
  return rig;
}

/// True if the views come from streams, false if they come from images.
bool usesStreams(const Options& options) {
  return options.left.empty() && (options.source == "live" || capture::isRecording(options.source));
}

/// The views and their images.
struct FoundViews {
  BoardViews views;
  ImagePairs pairs;                    ///< image files
  std::vector<DetectedView> streamed;  ///< views from streams
};

FoundViews viewsOfPairs(const Options& options, const calib::BoardSpec& board) {
  FoundViews found;
  found.pairs = findPairs(options);
  ProgressBar progress("pairs");
  found.views =
      findViews(found.pairs, board, [&](std::size_t done) { progress.show(done, found.pairs.pairs.size()); });
  return found;
}

FoundViews viewsOfStreams(capture::CameraSource& left, capture::CameraSource& right,
                          const calib::BoardSpec& board, StreamViewSettings settings, LivePage* page) {
  stopOnFirstInterrupt();
  settings.is_stop_requested = [] { return stop_requested != 0; };
  ViewGuide guide;
  StreamedViews streamed =
      viewsFromStreams(left, right, board, settings, [&](const StreamProgress& progress) {
        guide.show(progress);
        if (page != nullptr) page->show(progress);
      });
  guide.end();
  if (page != nullptr) page->showSolving();
  if (streamed.views.empty()) {
    throw std::runtime_error(
        "no view of the board: both cameras must see it, held still for a second; check "
        "that --board " +
        calib::boardSpecText(board) + " is the board shown");
  }
  FoundViews found;
  found.views = selectViews(streamed.views, board, streamed.image_size);
  std::vector<LargerBoardSample> samples;
  for (const DetectedView& view : streamed.views) {
    if (!view.left_image.empty() && samples.size() < kLargerBoardSamples)
      samples.push_back({view.view.name, view.left_image});
  }
  refuseLargerBoard(samples, board);
  found.streamed = std::move(streamed.views);
  return found;
}

FoundViews viewsOfLiveCameras(const Options& options, const calib::BoardSpec& board, LivePage* page,
                              KeptViews* kept) {
  const daemon::Configuration configuration =
      daemon::readConfiguration(options.configuration, daemon::RigKey::optional);
  capture::StereoTimestamper clock(configuration.clock);
  daemon::LiveCamera left(configuration, capture::CameraSide::left, {}, clock);
  daemon::LiveCamera right(configuration, capture::CameraSide::right, {}, clock);
  NewestFrame newest_left(left.source()), newest_right(right.source());
  std::fprintf(
      stderr,
      "cartvo: show the board to both cameras, and hold it still for a second at a time; Ctrl-C ends the "
      "collection and calibrates with the views so far\n");
  StreamViewSettings settings{.max_seconds = 900.0, .stop_when_complete = true};
  if (kept != nullptr) settings.keep_view = [kept](const DetectedView& view) { kept->add(view); };
  return viewsOfStreams(newest_left, newest_right, board, settings, page);
}

FoundViews viewsOf(const Options& options, const calib::BoardSpec& board, LivePage* page, KeptViews* kept) {
  if (!usesStreams(options)) return viewsOfPairs(options, board);
  if (options.source == "live") return viewsOfLiveCameras(options, board, page, kept);
  capture::RecordingSource left(options.source, capture::CameraSide::left),
      right(options.source, capture::CameraSide::right);
  return viewsOfStreams(left, right, board, {.max_seconds = 3600.0, .stop_when_complete = false}, page);
}

/// The first used view whose images are available.
ReportPair reportPair(const FoundViews& found, const calib::Calibration& calibration) {
  for (const calib::BoardView& used : calibration.views) {
    for (const ImagePair& pair : found.pairs.pairs) {
      if (pair.name != used.name) continue;
      return {pair.name, capture::readGreyImage(pair.left, found.pairs.grey_levels.left),
              capture::readGreyImage(pair.right, found.pairs.grey_levels.right)};
    }
    for (const DetectedView& view : found.streamed) {
      if (view.view.name == used.name && !view.left_image.empty())
        return {used.name, view.left_image, view.right_image};
    }
  }
  return {};
}

/// Date, version, source and rig file of a report.
std::string originOf(const Options& options) {
  return fmt::format("{}, cartvo {}, from {}, for the rig file {}", reportTime(), CARTVO_VERSION,
                     options.source.string(), options.output.string());
}

/// Calibrates, reports, and writes the rig file if the calibration passes. `before`: see rigBefore.
/// `summary`: receives the text report.
void calibrate(const Options& options, const calib::BoardSpec& board, const std::optional<calib::Rig>& before,
               LivePage* page, KeptViews* kept, std::string& summary) {
  const FoundViews found = viewsOf(options, board, page, kept);
  calib::Calibration calibration = calib::calibrateViews(found.views.views, board, found.views.image_size,
                                                         modelChoices().at(options.model));
  calibration.rejected.insert(calibration.rejected.begin(), found.views.rejected.begin(),
                              found.views.rejected.end());
  if (!options.report.empty())
    writeResultFile(options.report,
                    calibrationReport(calibration, originOf(options), reportPair(found, calibration)));
  summary = calibrationText(calibration);
  std::fputs((options.json ? jsonText(calibrationJson(calibration)) : summary).c_str(), stdout);
  if (!calibration.passed()) {
    throw std::runtime_error("the calibration does not pass its validation; " + options.output.string() +
                             " is not changed");
  }
  const calib::Rig rig = rigToWrite(calibration, before, options);
  calib::writeRig(options.output, rig);
  std::fprintf(stderr, "cartvo: the calibration passes%s; written to %s\n",
               calib::reservationsOf(calibration).empty() ? "" : ", with reservations",
               options.output.c_str());
  if (!options.json) printNextStep(rig, options.output);
}

/// Says how to calibrate again with the views of a live calibration that failed.
void printKeptViews(const KeptViews& kept, const Options& options) {
  std::fprintf(
      stderr,
      "cartvo: %zu views are kept in %s; to calibrate with them again: cartvo calibrate %s --board %s "
      "--output %s\n",
      kept.count(), kept.folder().c_str(), kept.folder().c_str(), options.board.c_str(),
      options.output.c_str());
}

/// Where the views of live cameras are kept: beside the report, else beside the rig file until that is
/// written.
std::filesystem::path viewsFolder(const Options& options) {
  std::filesystem::path folder = options.report.empty() ? options.output : options.report;
  return folder.replace_extension().concat("-views");
}

std::unique_ptr<LivePage> servePage(const ListenAddress& address, const calib::BoardSpec& board) {
  auto page = std::make_unique<LivePage>(address, board);
  std::fprintf(stderr, "cartvo: the page is at %s\n", page->url().c_str());
  if (!address.isLoopback())
    std::fprintf(stderr, "cartvo: anyone who can reach this address can see the cameras' pictures\n");
  return page;
}

void run(const Options& options) {
  const calib::BoardSpec board = calib::parseBoardSpec(options.board);
  const std::optional<calib::Rig> before = rigBefore(options.output);
  checkResultFiles({options.output, options.report});
  std::optional<KeptViews> kept;
  if (options.source == "live" && usesStreams(options)) kept.emplace(viewsFolder(options));
  const std::unique_ptr<LivePage> page = options.page ? servePage(*options.page, board) : nullptr;
  std::string summary;
  try {
    calibrate(options, board, before, page.get(), kept ? &*kept : nullptr, summary);
  } catch (const std::exception& error) {
    if (page) page->showResult(false, summary + error.what());
    if (kept && kept->count() > 0) printKeptViews(*kept, options);
    if (kept && kept->count() == 0) kept->remove();
    throw;
  }
  if (kept && options.report.empty()) kept->remove();
  if (page) page->showResult(true, summary);
}

void addSourceOptions(Command calibrate, Options& options) {
  calibrate.addOption(
      "SOURCE", options.source,
      "A folder with image_0 (left) and image_1 (right); a recording (cartvod --record); "
      "'live': the configured cameras; with --left-images and --right-images the folder of the images");
  const Option left = calibrate
                          .addOption("--left-images", options.left,
                                     "The left images: a pattern with one '*', such as 'L*.jpg'")
                          .typeName("PATTERN");
  const Option right =
      calibrate
          .addOption("--right-images", options.right,
                     "The right images; the text matched by '*' pairs them with the left ones")
          .typeName("PATTERN");
  left.needs(right);
  right.needs(left);
}

void addResultOptions(Command calibrate, Options& options) {
  calibrate
      .addOption("--board", options.board,
                 "The board, with the measured side of a square in metres:\n"
                 "chessboard:9x6:0.025 (inner corners), charuco:COLUMNSxROWS:SQUARE:MARKER or "
                 "aprilgrid:6x6:0.088:0.3")
      .typeName("BOARD");
  calibrate
      .addOption("--config", options.configuration,
                 "With 'live': cartvod's configuration file, which names the cameras")
      .typeName("FILE")
      .captureDefault();
  calibrate.addOption("--output", options.output, "Rig file to write if the calibration passes")
      .typeName("FILE");
  calibrate
      .addOption("--report", options.report,
                 "File for a report (one HTML page): residuals, coverage, models, error of the depth")
      .typeName("FILE");
  std::vector<std::string> models;
  for (const auto& [name, model] : modelChoices())
    models.push_back(name);
  calibrate
      .addOption(
          "--model", options.model,
          "Lens model: 'auto' selects the one that predicts held-out views best, 'brown' the best of Brown's")
      .choices(models)
      .typeName("MODEL")
      .captureDefault();
  calibrate
      .addOption(
          "--free-scaling", options.free_scaling,
          "Part of the images that rectification keeps: 0 crops until each pixel has a source, 1 keeps all")
      .range(0.0, 1.0)
      .typeName("SHARE")
      .captureDefault();
  calibrate.addFlag("--unusual-geometry", options.unusual_geometry,
                    "Accept a result that is unusual for a stereo pair on a vehicle, see "
                    "cartvo-calibrate-convert(1)");
  calibrate.addFlag("--json", options.json, "Print all numbers as JSON instead of the summary");
}

/// Throws CommandLineError for options that are missing or do not fit together.
void checkOptions(Options& options, bool has_page, const std::string& page) {
  if (options.source.empty() && options.left.empty())
    throw CommandLineError("SOURCE, or --left-images and --right-images is required");
  if (options.board.empty()) throw CommandLineError("--board is required");
  if (options.output.empty()) throw CommandLineError("--output is required");
  try {
    calib::parseBoardSpec(options.board);
  } catch (const std::invalid_argument& error) {
    throw CommandLineError("--board", error.what());
  }
  if (!has_page) return;
  if (!usesStreams(options))
    throw CommandLineError("--page", "works with live cameras or a recording only; for images use --report");
  try {
    options.page = page.empty() ? ListenAddress{.port = kDefaultPagePort} : ListenAddress::parse(page);
  } catch (const std::invalid_argument& error) {
    throw CommandLineError("--page", error.what());
  }
}

}  // namespace

void addCalibrateRig(Command calibrate) {
  const auto options = std::make_shared<Options>();
  addSourceOptions(calibrate, *options);
  addResultOptions(calibrate, *options);
  const auto page = std::make_shared<std::string>();
  const Option page_option =
      calibrate
          .addOption(
              "--page", *page,
              "With 'live' or a recording: serve a web page with both pictures and the next view to show\n"
              "(default: 127.0.0.1:8600, for browsers on this computer only; 0: any free port)")
          .typeName("[ADDRESS:]PORT")
          .expected(0, 1);
  calibrate.callback([options, page, page_option, calibrate] {
    if (calibrate.givenSubcommand()) return;
    checkOptions(*options, page_option.count() > 0, *page);
    run(*options);
  });
}

}  // namespace cartvo
