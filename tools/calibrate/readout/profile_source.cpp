// Reads row profiles from live cameras, recordings, image folders and videos.
#include "tools/calibrate/readout/profile_source.hpp"

#include <chrono>
#include <future>
#include <limits>
#include <stdexcept>

#include "daemon/service/configuration.hpp"
#include "daemon/service/live_camera.hpp"
#include "tools/calibrate/camera_files.hpp"

namespace cartvo::calibrate {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

}  // namespace

std::vector<RowProfile> readProfiles(capture::CameraSource& camera, double seconds) {
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
  }
  return profiles;
}

StereoProfiles profilesOfFiles(const std::filesystem::path& source, const std::filesystem::path& right,
                               double frame_rate) {
  const CameraFiles cameras = openCameraFiles(source, right, frame_rate);
  StereoProfiles profiles;
  profiles.left = readProfiles(*cameras.left, kForever);
  if (cameras.right) profiles.right = readProfiles(*cameras.right, kForever);
  return profiles;
}

StereoProfiles profilesOfLiveCameras(const std::filesystem::path& configuration_file, double seconds) {
  const daemon::Configuration configuration =
      daemon::readConfiguration(configuration_file, daemon::RigKey::optional);
  capture::StereoTimestamper clock(configuration.clock);
  daemon::LiveCamera left(configuration, capture::CameraSide::left, {}, clock);
  daemon::LiveCamera right(configuration, capture::CameraSide::right, {}, clock);
  // Both streams have to be read all the time.
  std::future<std::vector<RowProfile>> left_profiles =
      std::async(std::launch::async, [&] { return readProfiles(left.source(), seconds); });
  std::future<std::vector<RowProfile>> right_profiles =
      std::async(std::launch::async, [&] { return readProfiles(right.source(), seconds); });
  return {left_profiles.get(), right_profiles.get()};
}

}  // namespace cartvo::calibrate
