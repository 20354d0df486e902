// `cartvo calibrate readout`: measures the readout of rolling shutters with a lamp on the mains.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "calib/format/rig_file.hpp"
#include "capture/camera_source.hpp"
#include "common/command_line/parser.hpp"
#include "daemon/service/configuration.hpp"
#include "daemon/service/live_camera.hpp"
#include "tools/calibrate/camera_files.hpp"
#include "tools/calibrate/readout/mains_bands.hpp"
#include "tools/calibrate/rig_update.hpp"
#include "tools/calibrate/subcommands.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/result_files.hpp"

namespace cartvo::calibrate {
namespace {

// Reads row profiles from live cameras, recordings, image folders and videos.

constexpr std::size_t kMaxProfiles = 400;

/// Profiles of both cameras; empty for a camera that was not read.
struct StereoProfiles {
  std::vector<RowProfile> left, right;
};

/// Called during the work: how much of it is done, in pictures of both cameras, or in seconds of live
/// cameras. `total`: 0 if unknown.
using ProfileProgress = std::function<void(std::size_t done, std::size_t total)>;

constexpr double kForever = std::numeric_limits<double>::infinity();

/// Profiles of the first good pictures of a camera, at most kMaxProfiles, until it ends or `seconds` have
/// passed by the host's clock. Calls `picture_read` after each. Throws std::runtime_error if the size of its
/// pictures changes.
std::vector<RowProfile> readProfiles(capture::CameraSource& camera, double seconds,
                                     const std::function<void()>& picture_read) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  std::vector<RowProfile> profiles;
  cv::Size size;
  std::int64_t begin_ns = 0;
  capture::Frame frame;
  while (profiles.size() < kMaxProfiles &&
         std::chrono::duration<double>(Clock::now() - begin).count() < seconds) {
    const capture::ReadOutcome outcome = camera.read(frame, std::chrono::milliseconds(200));
    if (outcome == capture::ReadOutcome::ended) break;
    if (outcome != capture::ReadOutcome::frame || frame.status != capture::FrameStatus::good) continue;
    if (profiles.empty()) {
      size = frame.image.size();
      // Without the slew of the clock model: the bands move by the camera's own clock.
      begin_ns = frame.exposure_ns - frame.slew_ns;
    }
    if (frame.image.size() != size) throw std::runtime_error("the size of the pictures changes");
    profiles.push_back(
        rowProfile(frame.image, 1e-9 * static_cast<double>(frame.exposure_ns - frame.slew_ns - begin_ns)));
    picture_read();
  }
  return profiles;
}

/// Profiles from what openCameraFiles opens, with its arguments. Throws what it throws.
StereoProfiles profilesOfFiles(const std::filesystem::path& source, const std::filesystem::path& right,
                               double frame_rate, const ProfileProgress& progress) {
  const CameraFiles cameras = openCameraFiles(source, right, frame_rate);
  StereoProfiles profiles;
  const std::size_t total = std::min(cameras.pictures, kMaxProfiles) * (cameras.right ? 2 : 1);
  std::size_t done = 0;
  const auto picture_read = [&] { progress(++done, total); };
  profiles.left = readProfiles(*cameras.left, kForever, picture_read);
  if (cameras.right) profiles.right = readProfiles(*cameras.right, kForever, picture_read);
  return profiles;
}

/// Profiles from the cameras of a configuration file, during `seconds`. Throws what LiveCamera throws.
StereoProfiles profilesOfLiveCameras(const std::filesystem::path& configuration_file, double seconds,
                                     const ProfileProgress& progress) {
  const daemon::Configuration configuration =
      daemon::readConfiguration(configuration_file, daemon::RigKey::optional);
  capture::StereoTimestamper clock(configuration.clock);
  daemon::LiveCamera left(configuration, capture::CameraSide::left, {}, clock);
  daemon::LiveCamera right(configuration, capture::CameraSide::right, {}, clock);
  // Both streams have to be read all the time.
  std::future<std::vector<RowProfile>> left_profiles =
      std::async(std::launch::async, [&] { return readProfiles(left.source(), seconds, [] {}); });
  std::future<std::vector<RowProfile>> right_profiles =
      std::async(std::launch::async, [&] { return readProfiles(right.source(), seconds, [] {}); });
  const auto total = static_cast<std::size_t>(std::ceil(seconds));
  for (std::size_t second = 0; second < total; ++second) {
    progress(second, total);
    const auto is_done = [](const auto& profiles, std::chrono::milliseconds wait) {
      return profiles.wait_for(wait) == std::future_status::ready;
    };
    if (is_done(left_profiles, std::chrono::seconds(1)) && is_done(right_profiles, std::chrono::seconds(0)))
      break;
  }
  return {left_profiles.get(), right_profiles.get()};
}

}  // namespace
}  // namespace cartvo::calibrate

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using calibrate::ReadoutMeasurement;

struct Options : calibrate::RigUpdateOptions {
  fs::path configuration = "/etc/cartvo/cartvod.yaml";
  std::string camera = "both";
  double mains = 50.0, seconds = 20.0;

  bool isLive() const { return source == "live"; }
};

calibrate::StereoProfiles readAll(const Options& options) {
  ProgressBar progress(options.isLive() ? "s" : "pictures");
  const auto show = [&](std::size_t done, std::size_t total) { progress.show(done, total); };
  if (!options.isLive())
    return calibrate::profilesOfFiles(options.source, options.right_video, options.frame_rate, show);
  std::fprintf(stderr, "cartvo: reading both cameras for %.0f s\n", options.seconds);
  return calibrate::profilesOfLiveCameras(options.configuration, options.seconds, show);
}

std::string textOf(const char* side, const ReadoutMeasurement& measured) {
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(),
                "%-6s %+.3f +- %.3f ms, rows from %s, %.2f bands across the picture, amplitude %.1f %%, %zu "
                "pictures\n",
                side, 1e3 * measured.readout.value, 1e3 * measured.readout.stddev,
                measured.readout.value > 0.0 ? "top to bottom" : "bottom to top", measured.bands,
                100.0 * measured.amplitude, measured.pictures);
  return text.data();
}

nlohmann::ordered_json jsonOf(const ReadoutMeasurement& measured) {
  return {
      {"readout_ms", {{"value", 1e3 * measured.readout.value}, {"deviation", 1e3 * measured.readout.stddev}}},
      {"bands", measured.bands},
      {"amplitude", measured.amplitude},
      {"pictures", measured.pictures}};
}

ReadoutMeasurement measure(const char* side, const std::vector<calibrate::RowProfile>& profiles,
                           double mains) {
  try {
    return calibrate::measureReadout(profiles, mains);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string("the ") + side + " camera: " + error.what());
  }
}

void run(const Options& options) {
  if (options.isSingleVideo() && options.camera == "both")
    throw std::runtime_error(
        "one video is of one camera: give --camera left or --camera right, or both videos");
  calib::Rig rig;
  if (!options.output.empty()) {
    checkResultFiles({options.output});
    rig = calibrate::rigToChange(options, options.isLive());
  }
  calibrate::StereoProfiles profiles = readAll(options);
  if (options.isSingleVideo() && options.camera == "right") profiles.right.swap(profiles.left);
  nlohmann::ordered_json json;
  std::string text;
  const auto add = [&](const char* side, const std::vector<calibrate::RowProfile>& camera_profiles,
                       calib::CameraModel& camera) {
    const ReadoutMeasurement measured = measure(side, camera_profiles, options.mains);
    camera.readout = measured.readout.value;
    json[side] = jsonOf(measured);
    text += textOf(side, measured);
  };
  if (options.camera != "right") add("left", profiles.left, rig.left);
  if (options.camera != "left") add("right", profiles.right, rig.right);
  if (!options.output.empty()) calib::writeRig(options.output, rig);
  std::fputs((options.json ? jsonText(json) : text).c_str(), stdout);
  if (!options.output.empty() && !options.json) std::printf("written to %s\n", options.output.c_str());
}

}  // namespace

void addCalibrateReadout(Command calibrate) {
  const Command command = calibrate.addSubcommand(
      "readout", "Readout of the cameras' rolling shutters, from the bands of a lamp on the mains");
  const auto options = std::make_shared<Options>();
  addRigUpdateOptions(
      command, *options,
      "'live': the configured cameras; a recording (cartvod --record), a folder in KITTI's or EuRoC's "
      "layout, or a video",
      "Rig file to write the readouts to; the rest of an existing one is kept. Without it they are only "
      "printed");
  command.addOption("--camera", options->camera, "Camera to measure; that of a single video")
      .choices({"both", "left", "right"})
      .typeName("CAMERA")
      .captureDefault();
  command.addOption("--mains", options->mains, "Frequency of the mains, Hz: 50 or 60")
      .choices({50.0, 60.0})
      .typeName("HZ")
      .captureDefault();
  command
      .addOption("--config", options->configuration,
                 "With 'live': cartvod's configuration file, which names the cameras")
      .typeName("FILE")
      .captureDefault();
  command.addOption("--seconds", options->seconds, "With 'live': how long to read the cameras")
      .range(3.0, 600.0)
      .captureDefault();
  command.footer(
      "Let the cameras stand before a lamp on the mains, or a wall lit by it, without daylight, with a "
      "short\n"
      "exposure (1/250 s or shorter) at 18 frames a second. Stop cartvod before 'live'.\n"
      "Examples:\n"
      "  cartvo calibrate readout live --output rig.yaml\n"
      "  cartvo calibrate readout left.mp4 --camera left --mains 60 --output rig.yaml");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
