// `cartvo calibrate mask`: finds the parts of the pictures that never show the scene.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "calib/format/mask_key.hpp"
#include "calib/format/rig_file.hpp"
#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "common/image_size.hpp"
#include "tools/calibrate/camera_files.hpp"
#include "tools/calibrate/mask/static_parts.hpp"
#include "tools/calibrate/rig_update.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/result_files.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using calibrate::StaticParts;
using Options = calibrate::RigUpdateOptions;

StaticParts find(capture::CameraSource& camera, const std::string& side, std::size_t expected) {
  calibrate::StaticPartFinder finder;
  ProgressBar progress("pictures, " + side);
  std::size_t pictures = 0;
  capture::Frame frame;
  try {
    while (true) {
      const capture::ReadOutcome outcome = camera.read(frame, std::chrono::milliseconds(200));
      if (outcome == capture::ReadOutcome::ended) break;
      if (outcome != capture::ReadOutcome::frame || frame.status != capture::FrameStatus::good) continue;
      finder.add(frame.image, frame.exposure_ns);
      progress.show(++pictures, expected);
    }
    return finder.result();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("the " + side + " camera: " + error.what());
  }
}

std::string textOf(const char* side, const StaticParts& parts) {
  constexpr std::size_t kMaxBoxes = 5;
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "%-6s %.1f %% of the picture is static, from %zu pictures\n", side,
                100.0 * parts.share, parts.pictures);
  std::string all = text.data();
  for (std::size_t i = 0; i < std::min(parts.boxes.size(), kMaxBoxes); ++i) {
    const cv::Rect& box = parts.boxes[i];
    std::snprintf(text.data(), text.size(), "       x %d to %d, y %d to %d px\n", box.x, box.br().x - 1,
                  box.y, box.br().y - 1);
    all += text.data();
  }
  if (parts.boxes.size() > kMaxBoxes)
    all += "       and " + std::to_string(parts.boxes.size() - kMaxBoxes) + " smaller parts\n";
  return all;
}

nlohmann::ordered_json jsonOf(const StaticParts& parts) {
  nlohmann::ordered_json boxes = nlohmann::ordered_json::array();
  for (const cv::Rect& box : parts.boxes)
    boxes.push_back({box.x, box.y, box.width, box.height});
  return {{"share", parts.share}, {"pictures", parts.pictures}, {"boxes", boxes}};
}

fs::path maskFile(const fs::path& rig, const std::string& side) {
  return rig.parent_path() / (rig.stem().string() + "-mask-" + side + ".png");
}

void requireSize(const StaticParts& parts, const std::string& side, const calib::CameraModel& camera) {
  if (parts.used.size() == camera.size) return;
  throw std::runtime_error("the " + side + " camera's pictures are " + sizeText(parts.used.size()) +
                           " but the rig was calibrated at " + sizeText(camera.size));
}

/// Writes the mask and puts it into the camera; a camera without static parts has no mask.
void setMask(const StaticParts& parts, const fs::path& file, calib::CameraModel& camera) {
  camera.mask = {};
  if (parts.boxes.empty()) return;
  camera.mask.used = parts.used;
  camera.mask.file = file;
  writeResultFile(file, calib::maskPng(camera.mask));
}

void run(const Options& options) {
  if (options.isSingleVideo()) throw std::runtime_error("one video is of one camera: give both videos");
  const fs::path left_file = maskFile(options.output, "left"), right_file = maskFile(options.output, "right");
  calib::Rig rig;
  if (!options.output.empty()) {
    checkResultFiles({options.output, left_file, right_file});
    rig = calibrate::rigToChange(options);
  }
  const calibrate::CameraFiles cameras =
      calibrate::openCameraFiles(options.source, options.right_video, options.frame_rate);
  const StaticParts left = find(*cameras.left, "left", cameras.pictures),
                    right = find(*cameras.right, "right", cameras.pictures);
  if (!options.output.empty()) {
    requireSize(left, "left", rig.left);
    requireSize(right, "right", rig.right);
    setMask(left, left_file, rig.left);
    setMask(right, right_file, rig.right);
    calib::writeRig(options.output, rig);
  }
  const std::string report =
      options.json ? jsonText(nlohmann::ordered_json{{"left", jsonOf(left)}, {"right", jsonOf(right)}})
                   : textOf("left", left) + textOf("right", right);
  std::fputs(report.c_str(), stdout);
  if (options.output.empty() || options.json) return;
  std::printf("written to %s\n", options.output.c_str());
  for (const calib::CameraModel* camera : {&rig.left, &rig.right})
    if (!camera->mask.empty()) std::printf("written to %s: look at it\n", camera->mask.file.c_str());
}

}  // namespace

void addCalibrateMask(Command calibrate) {
  const Command command = calibrate.addSubcommand(
      "mask", "Parts of the pictures that never move, such as the roof edge, from a drive");
  const auto options = std::make_shared<Options>();
  addRigUpdateOptions(
      command, *options,
      "A drive: a recording (cartvod --record), a folder in KITTI's or EuRoC's layout, or the left camera's "
      "video",
      "Rig file to write the masks to; the rest of an existing one is kept. The masks are PNG files beside "
      "it. Without it they are only described");
  command.footer(
      "Record a drive of a minute or more, with curves, by daylight. Landmarks in a mask are never used.\n"
      "The masks can be painted over: black is not used.\n"
      "Examples:\n"
      "  cartvo calibrate mask recordings/first --rig rig.yaml --output rig.yaml\n"
      "  cartvo calibrate mask left.mp4 right.mp4");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
