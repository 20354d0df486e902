#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <spdlog/common.h>

#include "capture/rtsp_camera.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo {

struct CameraConfiguration {
  std::string url;                      ///< rtsp://HOST[:PORT]/PATH, without user and password
  std::string username;                 ///< empty: the camera asks for none
  std::filesystem::path password_file;  ///< absolute; empty: see `password_credential`
  std::string password_credential;      ///< name of a file under $CREDENTIALS_DIRECTORY; empty: none
};

/// All that cartvod can be told, with the defaults of config/cartvod.yaml, where each key is explained.
struct Configuration {
  CameraConfiguration left;
  CameraConfiguration right;
  RtspTransport transport = RtspTransport::tcp;
  RtspInstants instants = RtspInstants::sender_reports;
  double frame_rate = 18.0;  ///< Hz
  std::chrono::milliseconds stall_timeout{1000};

  std::filesystem::path rig;     ///< absolute
  std::filesystem::path tables;  ///< absolute; empty: computed at each start

  OdometrySettings odometry;
  int threads = 2;  ///< for the image operations of one pair

  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::chrono::milliseconds time_to_live{250};

  std::filesystem::path recording_directory;  ///< absolute; empty: no recording
  spdlog::level::level_enum log_level = spdlog::level::info;
};

/// Reads a configuration strictly: an unknown, missing or repeated key, a wrong type or a value out of range
/// throws std::runtime_error naming file, line, key, what was expected and what was found. Relative paths are
/// taken from the file's folder. Opens no other file.
Configuration readConfiguration(const std::filesystem::path& file);

/// The configuration in effect as YAML that `readConfiguration` reads back; passwords are not in it, only
/// where they come from. A recording keeps it beside its streams.
std::string effectiveConfiguration(const Configuration& configuration);

/// Every key that `readConfiguration` knows, as "cameras.left.url".
std::vector<std::string> configurationKeys();

}  // namespace cartvo
