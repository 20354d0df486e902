// Reads cartvod's configuration file. config/cartvod.yaml explains each key; a test compares it with the keys
// here.

#include "daemon/service/configuration.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <regex>
#include <stdexcept>
#include <utility>

#include "calib/model/rig_validation.hpp"
#include "capture/rtsp/rtsp_url.hpp"
#include "common/image_size.hpp"
#include "common/strict_yaml.hpp"
#include "common/units.hpp"
#include "daemon/publish/lcm_connection.hpp"
#include "daemon/service/configuration_names.hpp"

namespace cartvo::daemon {
namespace {

using Keys = std::initializer_list<const char*>;
constexpr Keys kRootKeys = {"cameras",   "rig",     "tables", "odometry", "lcm",
                            "recording", "metrics", "page",   "logging"};
constexpr Keys kCamerasKeys = {"left",           "right",           "transport",
                               "clock",          "authentication",  "frame_rate",
                               "answer_timeout", "connect_timeout", "stall_timeout"};
constexpr Keys kCameraKeys = {"url",    "username", "password_file", "password_credential",
                              "size",   "format",   "exposure",      "gain",
                              "readout"};
constexpr Keys kOdometryKeys = {"estimator",
                                "features",
                                "seed",
                                "threads",
                                "online_rig_refinement",
                                "maximum_offset",
                                "maximum_offset_uncertainty",
                                "alert_limits"};
constexpr Keys kAlertLimitsKeys = {"velocity", "angular_rate", "motion", "rotation"};
constexpr Keys kLcmKeys = {"url", "time_to_live", "pose_channel", "pose_velocity"};
constexpr Keys kRecordingKeys = {"directory", "start", "maximum_size", "maximum_age", "keep_free"};
constexpr Keys kMetricsKeys = {"listen"};
constexpr Keys kPageKeys = {"listen", "token_file", "token_credential"};
constexpr Keys kLoggingKeys = {"level"};

/// Parses one of the named values; the error lists them.
template <typename Value, std::size_t count>
Value choice(const StrictYaml& yaml, const std::array<std::pair<const char*, Value>, count>& choices) {
  std::string names;
  for (const auto& [name, value] : choices) {
    if (yaml.text() == name) return value;
    names += (names.empty() ? "" : ", ") + std::string(name);
  }
  yaml.failExpecting("one of " + names);
}

std::chrono::milliseconds duration(const StrictYaml& seconds, double minimum, double maximum) {
  return std::chrono::milliseconds(std::llround(1000.0 * seconds.number(minimum, maximum, "s")));
}

/// Parses a path; a relative one is relative to the configuration file's folder.
std::filesystem::path path(const StrictYaml& yaml, const std::filesystem::path& folder) {
  if (yaml.text().empty()) yaml.failExpecting("a path");
  return (folder / yaml.text()).lexically_normal();
}

std::string streamUrl(const StrictYaml& yaml) {
  static const std::regex kV4l2Url("v4l2:/.+");
  std::string url = yaml.text();
  if (std::regex_match(url, kV4l2Url)) return url;
  if (url.find('@') != std::string::npos) {
    // The error does not quote the value, because it contains a password.
    yaml.fail(
        "a URL must not contain user and password, because URLs are logged; use username and "
        "password_file or password_credential");
  }
  try {
    capture::checkRtspUrl(url);
  } catch (const std::invalid_argument& error) {
    yaml.fail(std::string(error.what()) + " (or v4l2:/dev/video0); found '" + url + "'");
  }
  return url;
}

cv::Size imageSize(const StrictYaml& yaml) {
  const std::optional<cv::Size> size = parseImageSize(yaml.text());
  if (!size) yaml.failExpecting("a size in pixels such as 1280x720");
  return *size;
}

/// Reads the keys of a V4L2 camera. Fails for keys that do not belong to the camera's kind.
void readV4l2Keys(const StrictYaml& yaml, CameraConfiguration& camera) {
  const auto reject_keys = [&](const Keys& keys, const char* kind) {
    for (const char* key : keys)
      if (yaml.has(key)) yaml[key].fail(std::string("only ") + kind + " has this key");
  };
  if (!camera.isV4l2()) return reject_keys({"size", "format", "exposure", "gain"}, "a V4L2 camera");
  reject_keys({"username", "password_file", "password_credential"}, "an IP camera");
  if (yaml.has("size")) camera.size = imageSize(yaml["size"]);
  if (yaml.has("format")) camera.format = choice(yaml["format"], kFormats);
  if (yaml.has("exposure")) camera.exposure = yaml["exposure"].number(1e-5, 1.0, "s");
  if (yaml.has("gain")) camera.gain = static_cast<int>(yaml["gain"].integer(0, 1'000'000));
}

std::string credentialName(const StrictYaml& yaml) {
  std::string name = yaml.text();
  if (name.empty() || name.find('/') != std::string::npos || name.starts_with('.'))
    yaml.failExpecting("the name of a systemd credential, without '/' and not beginning with '.'");
  return name;
}

std::filesystem::path credentialsFolder(const std::filesystem::path& folder) {
  return folder / "credentials";
}

CameraConfiguration readCamera(const StrictYaml& yaml, const std::filesystem::path& folder) {
  yaml.allowOnly(kCameraKeys);
  CameraConfiguration camera;
  camera.url = streamUrl(yaml["url"]);
  if (yaml.has("username")) camera.username = yaml["username"].text();
  if (yaml.has("password_file")) camera.password_file = path(yaml["password_file"], folder);
  if (yaml.has("password_credential")) {
    camera.password_credential = credentialName(yaml["password_credential"]);
    camera.credentials = credentialsFolder(folder);
  }
  readV4l2Keys(yaml, camera);
  if (yaml.has("readout"))
    camera.readout = yaml["readout"].number(-calib::kMaxReadout, calib::kMaxReadout, "s");
  const bool has_file = !camera.password_file.empty();
  const bool has_credential = !camera.password_credential.empty();
  if (has_file && has_credential) yaml.fail("give either password_file or password_credential, not both");
  if (!camera.username.empty() && !has_file && !has_credential) {
    yaml.fail("username needs password_file or password_credential");
  }
  if (camera.username.empty() && (has_file || has_credential)) {
    yaml.fail("a password needs username");
  }
  return camera;
}

void readTimeouts(const StrictYaml& cameras, Configuration& configuration) {
  const auto read = [&](const char* key, std::chrono::milliseconds& timeout) {
    if (cameras.has(key)) timeout = duration(cameras[key], 0.1, 60.0);
  };
  read("answer_timeout", configuration.answer_timeout);
  read("connect_timeout", configuration.connect_timeout);
  read("stall_timeout", configuration.stall_timeout);
}

void readCameras(const StrictYaml& yaml, const std::filesystem::path& folder, Configuration& configuration) {
  yaml.allowOnly(kCamerasKeys);
  configuration.left = readCamera(yaml["left"], folder);
  configuration.right = readCamera(yaml["right"], folder);
  if (configuration.left.url == configuration.right.url) {
    yaml["right"]["url"].fail("both cameras have the same URL; stereo needs two");
  }
  if (yaml.has("transport")) {
    configuration.transport = choice(yaml["transport"], kTransports);
  }
  if (yaml.has("authentication"))
    configuration.basic_authentication = choice(yaml["authentication"], kAuthentications);
  if (yaml.has("clock")) configuration.clock = choice(yaml["clock"], kClocks);
  if (yaml.has("frame_rate")) configuration.frame_rate = yaml["frame_rate"].number(1.0, 240.0, "Hz");
  readTimeouts(yaml, configuration);
}

vo::RigRefinement rigRefinement(const StrictYaml& yaml) {
  if (yaml.text() == "monitor") {
    yaml.fail(
        "'monitor' was removed: use 'correct' to have the right camera's rotation estimated, published and "
        "corrected, or 'off'");
  }
  return choice(yaml, kRigRefinements);
}

/// Limits above these ranges are none; below them no motion is ever valid.
void readAlertLimits(const StrictYaml& yaml, pipeline::AlertLimits& limits) {
  yaml.allowOnly(kAlertLimitsKeys);
  if (yaml.has("velocity")) limits.velocity = yaml["velocity"].number(0.01, 100.0, "m/s");
  if (yaml.has("angular_rate"))
    limits.angular_rate = kRadiansPerDegree * yaml["angular_rate"].number(0.1, 1000.0, "deg/s");
  if (yaml.has("motion")) limits.motion = yaml["motion"].number(0.01, 100.0, "m");
  if (yaml.has("rotation")) limits.rotation = kRadiansPerDegree * yaml["rotation"].number(0.1, 180.0, "deg");
}

void readOdometry(const StrictYaml& yaml, Configuration& configuration) {
  yaml.allowOnly(kOdometryKeys);
  vo::OdometrySettings& odometry = configuration.odometry;
  if (yaml.has("estimator")) {
    odometry.estimator = choice(yaml["estimator"], kEstimators);
  }
  if (yaml.has("features")) odometry.features = static_cast<int>(yaml["features"].integer(50, 20000));
  if (yaml.has("seed")) {
    odometry.seed = static_cast<std::uint64_t>(yaml["seed"].integer(0, std::int64_t{1} << 53));
  }
  if (yaml.has("online_rig_refinement"))
    odometry.rig_refinement = rigRefinement(yaml["online_rig_refinement"]);
  if (yaml.has("maximum_offset"))
    odometry.validity.maximum_offset = yaml["maximum_offset"].number(0.0, 1.0, "s");
  if (yaml.has("maximum_offset_uncertainty")) {
    odometry.validity.maximum_offset_uncertainty = yaml["maximum_offset_uncertainty"].number(0.0, 1.0, "s");
  }
  if (yaml.has("alert_limits")) readAlertLimits(yaml["alert_limits"], configuration.alert_limits);
  if (yaml.has("threads")) configuration.threads = static_cast<int>(yaml["threads"].integer(1, 64));
}

/// Both keys or none: a default of the velocity's axes would be wrong for half of the programs that use it.
void readPose(const StrictYaml& lcm, Configuration& configuration) {
  if (!lcm.has("pose_channel") && !lcm.has("pose_velocity")) return;
  static const std::regex kChannel("[A-Za-z0-9_.-]{1,63}");
  if (lcm.has("pose_velocity")) configuration.pose_velocity = choice(lcm["pose_velocity"], kPoseVelocities);
  configuration.pose_channel = lcm["pose_channel"].text();
  const bool is_own =
      configuration.pose_channel == kOdometryChannel || configuration.pose_channel == kHealthChannel;
  if (is_own || !std::regex_match(configuration.pose_channel, kChannel))
    lcm["pose_channel"].failExpecting(
        "a channel such as POSE_BODY, of letters, digits, '_', '.' and '-', not one of cartvod's");
  if (!lcm.has("pose_velocity"))
    lcm["pose_channel"].fail("needs pose_velocity, the axes of the velocity: local or body");
}

void readLcm(const StrictYaml& yaml, Configuration& configuration) {
  yaml.allowOnly(kLcmKeys);
  if (yaml.has("url")) {
    configuration.lcm_url = yaml["url"].text();
    try {
      parseLcmUrl(configuration.lcm_url);
    } catch (const std::invalid_argument& error) {
      yaml["url"].fail(error.what());
    }
  }
  if (yaml.has("time_to_live")) configuration.time_to_live = duration(yaml["time_to_live"], 0.01, 10.0);
  readPose(yaml, configuration);
}

void readRecording(const StrictYaml& yaml, const std::filesystem::path& folder,
                   Configuration& configuration) {
  yaml.allowOnly(kRecordingKeys);
  if (yaml.has("directory")) configuration.recording_directory = path(yaml["directory"], folder);
  if (yaml.has("start")) configuration.recording_start = choice(yaml["start"], kRecordingStarts);
  capture::RecordingQuota& quota = configuration.recording_quota;
  const auto bytes = [](const StrictYaml& gigabytes, double minimum) {
    return static_cast<std::uint64_t>(std::llround(gigabytes.number(minimum, 1e6, "GB") * kGigabyte));
  };
  if (yaml.has("maximum_size")) quota.maximum_bytes = bytes(yaml["maximum_size"], 1.0);
  if (yaml.has("maximum_age")) {
    quota.maximum_age =
        std::chrono::seconds(std::llround(yaml["maximum_age"].number(0.01, 1e4, "days") * kDay));
  }
  if (yaml.has("keep_free")) quota.keep_free_bytes = bytes(yaml["keep_free"], 0.0);
}

ListenAddress listenAddress(const StrictYaml& yaml) {
  try {
    return ListenAddress::parse(yaml.text());
  } catch (const std::invalid_argument& error) {
    yaml.fail(error.what());
  }
}

void readMetrics(const StrictYaml& yaml, Configuration& configuration) {
  yaml.allowOnly(kMetricsKeys);
  if (!yaml.has("listen")) return;
  configuration.metrics = listenAddress(yaml["listen"]);
  if (!configuration.metrics->isLoopback() || configuration.metrics->port == 0)
    yaml["listen"].failExpecting("a port of this computer such as 9464 or 127.0.0.1:9464");
}

void readPage(const StrictYaml& yaml, const std::filesystem::path& folder, Configuration& configuration) {
  yaml.allowOnly(kPageKeys);
  PageConfiguration& page = configuration.page;
  if (yaml.has("token_file")) page.token_file = path(yaml["token_file"], folder);
  if (yaml.has("token_credential")) {
    page.token_credential = credentialName(yaml["token_credential"]);
    page.credentials = credentialsFolder(folder);
  }
  if (!page.token_file.empty() && !page.token_credential.empty())
    yaml.fail("give either token_file or token_credential, not both");
  if (!yaml.has("listen")) return;
  page.listen = listenAddress(yaml["listen"]);
  if (page.listen->port == 0) yaml["listen"].failExpecting("a port such as 9465, or ADDRESS:PORT");
  if (!page.listen->isLoopback() && !page.hasToken())
    yaml["listen"].fail("other computers reach this address: the page needs token_file or token_credential");
}

void readLogging(const StrictYaml& yaml, Configuration& configuration) {
  yaml.allowOnly(kLoggingKeys);
  if (!yaml.has("level")) return;
  configuration.log_level = choice(yaml["level"], kLogLevels);
}

Configuration buildConfiguration(const StrictYaml& yaml, const std::filesystem::path& folder, RigKey rig) {
  yaml.allowOnly(kRootKeys);

  Configuration configuration;
  configuration.lcm_url = defaultLcmUrl();
  readCameras(yaml["cameras"], folder, configuration);
  if (rig == RigKey::required || yaml.has("rig")) configuration.rig = path(yaml["rig"], folder);
  if (yaml.has("tables")) configuration.tables = path(yaml["tables"], folder);
  if (yaml.has("odometry")) readOdometry(yaml["odometry"], configuration);
  if (yaml.has("lcm")) readLcm(yaml["lcm"], configuration);
  if (yaml.has("recording")) readRecording(yaml["recording"], folder, configuration);
  if (yaml.has("metrics")) readMetrics(yaml["metrics"], configuration);
  if (yaml.has("page")) readPage(yaml["page"], folder, configuration);
  if (yaml.has("logging")) readLogging(yaml["logging"], configuration);
  return configuration;
}

}  // namespace

Configuration readConfiguration(const std::filesystem::path& file, RigKey rig) {
  return buildConfiguration(StrictYaml::readFile(file), std::filesystem::absolute(file).parent_path(), rig);
}

Configuration parseConfiguration(const std::string& text, const std::filesystem::path& name) {
  return buildConfiguration(StrictYaml::parse(text, name), std::filesystem::absolute(name).parent_path(),
                            RigKey::required);
}

calib::Rig withConfiguredReadouts(calib::Rig rig, const Configuration& configuration) {
  if (configuration.left.readout) rig.left.readout = configuration.left.readout;
  if (configuration.right.readout) rig.right.readout = configuration.right.readout;
  return rig;
}

std::vector<std::string> configurationKeys() {
  std::vector<std::string> keys(kRootKeys.begin(), kRootKeys.end());
  const auto add = [&keys](const std::string& section, const Keys& names) {
    for (const char* name : names) {
      keys.push_back(section + "." + name);
    }
  };
  add("cameras", kCamerasKeys);
  add("cameras.left", kCameraKeys);
  add("cameras.right", kCameraKeys);
  add("odometry", kOdometryKeys);
  add("odometry.alert_limits", kAlertLimitsKeys);
  add("lcm", kLcmKeys);
  add("recording", kRecordingKeys);
  add("metrics", kMetricsKeys);
  add("page", kPageKeys);
  add("logging", kLoggingKeys);
  return keys;
}

}  // namespace cartvo::daemon
