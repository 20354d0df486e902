#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>
#include <spdlog/common.h>

#include "calib/model/rig.hpp"
#include "capture/recording/recording_folder.hpp"
#include "capture/rtsp/rtsp_camera.hpp"
#include "capture/v4l2/v4l2_picture.hpp"
#include "common/http/listen_address.hpp"
#include "daemon/publish/lcm_url.hpp"
#include "daemon/publish/pose_publisher.hpp"
#include "pipeline/protection_level.hpp"

// Configuration file of cartvod.

namespace cartvo::daemon {

/// Configuration of one camera.
struct CameraConfiguration {
  std::string url;                      ///< rtsp://HOST[:PORT]/PATH without user and password, or v4l2:DEVICE
  std::string username;                 ///< empty: no authentication
  std::filesystem::path password_file;  ///< absolute; empty: see `password_credential`
  std::string password_credential;      ///< name of a file, see readPassword; empty: none
  std::filesystem::path credentials;    ///< absolute; the folder "credentials" beside the configuration
  cv::Size size;                        ///< px, V4L2 only; empty: the rig's
  std::optional<capture::PixelFormat> format;  ///< V4L2 only, see V4l2CameraSettings, as are the next two
  std::optional<double> exposure;              ///< s
  std::optional<int> gain;
  std::optional<double> readout;  ///< s, replaces the rig's, see CameraModel::readout

  bool isV4l2() const { return url.starts_with("v4l2:"); }
  /// Device file of a V4L2 camera, for example /dev/video0.
  std::filesystem::path device() const { return url.substr(sizeof("v4l2:") - 1); }
};

/// Configuration of the status page.
struct PageConfiguration {
  std::optional<ListenAddress> listen;  ///< empty: not served
  std::filesystem::path token_file;     ///< absolute; empty: see `token_credential`
  std::string token_credential;         ///< name of a file, see readPageToken; empty: none
  std::filesystem::path credentials;    ///< as CameraConfiguration's

  bool hasToken() const { return !token_file.empty() || !token_credential.empty(); }
};

/// When a recording starts.
enum class RecordingStart : std::uint8_t {
  automatic,  ///< with cartvod
  by_hand,    ///< from the status page
};

/// Configuration of cartvod with its defaults; config/cartvod.yaml explains each key.
struct Configuration {
  CameraConfiguration left;
  CameraConfiguration right;
  capture::RtspTransport transport = capture::RtspTransport::tcp;
  bool basic_authentication = false;  ///< as RtspCameraSettings'
  capture::ClockChoice clock = capture::ClockChoice::automatic;
  /// Hz: of V4L2 cameras the rate to ask for; of IP cameras the rate that they are set to, for a comparison
  /// with the one that is measured. Nothing else depends on it.
  std::optional<double> frame_rate;
  std::chrono::milliseconds answer_timeout{
      1000};  ///< IP cameras only, see RtspCameraSettings, as is the next
  std::chrono::milliseconds connect_timeout{5000};
  std::chrono::milliseconds stall_timeout{1000};  ///< IP and V4L2 cameras

  std::filesystem::path rig;     ///< absolute
  std::filesystem::path tables;  ///< absolute; empty: tables are computed at each start

  vo::OdometrySettings odometry;
  pipeline::AlertLimits alert_limits;
  int threads = 2;  ///< for the image operations of one pair

  std::string lcm_url = kDefaultLcmUrl;  ///< read from a file: defaultLcmUrl() where the file has none
  std::chrono::milliseconds time_to_live{250};
  std::string pose_channel;  ///< of bot_core.pose_t; empty: not published
  PoseVelocity pose_velocity = PoseVelocity::local;

  std::filesystem::path recording_directory;  ///< absolute; empty: no recording
  RecordingStart recording_start = RecordingStart::automatic;
  /// `recordings` (the folder whose old recordings may be deleted) is set by cartvod, not by the file.
  capture::RecordingQuota recording_quota{{}, 20'000'000'000, std::chrono::seconds{0}, 1'000'000'000};
  std::optional<ListenAddress> metrics;  ///< on loopback; empty: not served
  PageConfiguration page;
  spdlog::level::level_enum log_level = spdlog::level::info;
};

/// Whether the key rig: must be there; a calibration does without.
enum class RigKey : std::uint8_t { required, optional };

/// Reads a configuration file strictly: an unknown, missing or repeated key, a wrong type or a value out of
/// range throws std::runtime_error naming file, line, key, expected and found value. Relative paths are
/// relative to the file's folder. Opens no other file.
Configuration readConfiguration(const std::filesystem::path& file, RigKey rig = RigKey::required);

/// Reads a configuration from text (of a recording). `name`: file name for errors; relative paths are
/// relative to its folder.
Configuration parseConfiguration(const std::string& text, const std::filesystem::path& name);

/// Writes the configuration as YAML that `readConfiguration` reads back. It names the sources of the
/// passwords, not the passwords. A recording stores it.
std::string effectiveConfiguration(const Configuration& configuration);

/// The rig with the readouts of the configuration where it states them.
calib::Rig withConfiguredReadouts(calib::Rig rig, const Configuration& configuration);

/// All keys that `readConfiguration` accepts, for example "cameras.left.url".
std::vector<std::string> configurationKeys();

}  // namespace cartvo::daemon
