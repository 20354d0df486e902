#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>
#include <spdlog/common.h>

#include "capture/recording_quota.hpp"
#include "capture/rtsp_camera.hpp"
#include "capture/v4l2_picture.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

struct CameraConfiguration {
  std::string url;                      ///< rtsp://HOST[:PORT]/PATH without user and password, or v4l2:DEVICE
  std::string username;                 ///< empty: the camera asks for none
  std::filesystem::path password_file;  ///< absolute; empty: see `password_credential`
  std::string password_credential;      ///< name of a file under $CREDENTIALS_DIRECTORY; empty: none
  cv::Size size;                        ///< px, of a V4L2 camera; empty: the rig's
  std::optional<PixelFormat> format;    ///< of a V4L2 camera, as V4l2CameraSettings', like the next two
  std::optional<double> exposure;       ///< s
  std::optional<int> gain;

  bool isV4l2() const { return url.starts_with("v4l2:"); }
  /// Of a V4L2 camera, such as /dev/video0.
  std::filesystem::path device() const { return url.substr(sizeof("v4l2:") - 1); }
};

/// All that cartvod can be told, with the defaults of config/cartvod.yaml, where each key is explained.
struct Configuration {
  CameraConfiguration left;
  CameraConfiguration right;
  RtspTransport transport = RtspTransport::tcp;
  ClockChoice clock = ClockChoice::automatic;
  double frame_rate = 18.0;                        ///< Hz
  std::chrono::milliseconds answer_timeout{1000};  ///< of IP cameras, as RtspCameraSettings', like the next
  std::chrono::milliseconds connect_timeout{5000};
  std::chrono::milliseconds stall_timeout{1000};  ///< of cameras of either kind

  std::filesystem::path rig;     ///< absolute
  std::filesystem::path tables;  ///< absolute; empty: computed at each start

  OdometrySettings odometry;
  int threads = 2;  ///< for the image operations of one pair

  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::chrono::milliseconds time_to_live{250};

  std::filesystem::path recording_directory;  ///< absolute; empty: no recording
  /// Its `recordings` is left to who knows what may be deleted.
  RecordingQuota recording_quota{{}, 20'000'000'000, std::chrono::seconds{0}, 1'000'000'000};
  spdlog::level::level_enum log_level = spdlog::level::info;
};

/// Reads a configuration strictly: an unknown, missing or repeated key, a wrong type or a value out of range
/// throws std::runtime_error naming file, line, key, what was expected and what was found. Relative paths are
/// taken from the file's folder. Opens no other file.
Configuration readConfiguration(const std::filesystem::path& file);

/// The same of a text that lies elsewhere (in a recording); `name` stands for the file in errors, and
/// relative paths are taken from its folder.
Configuration parseConfiguration(const std::string& text, const std::filesystem::path& name);

/// The configuration in effect as YAML that `readConfiguration` reads back; passwords are not in it, only
/// where they come from. A recording keeps it beside its streams.
std::string effectiveConfiguration(const Configuration& configuration);

/// Every key that `readConfiguration` knows, as "cameras.left.url".
std::vector<std::string> configurationKeys();

}  // namespace cartvo
