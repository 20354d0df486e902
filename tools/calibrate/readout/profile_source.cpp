// Reads row profiles from live cameras, recordings, image folders and videos.
#include "tools/calibrate/readout/profile_source.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
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

}  // namespace cartvo::calibrate
