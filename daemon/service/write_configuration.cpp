// Writes cartvod's configuration.

#include <chrono>
#include <string>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "common/image_size.hpp"
#include "common/units.hpp"
#include "daemon/service/configuration.hpp"
#include "daemon/service/configuration_names.hpp"

namespace cartvo::daemon {
namespace {

void emitRecording(YAML::Emitter& yaml, const Configuration& configuration) {
  const capture::RecordingQuota& quota = configuration.recording_quota;
  yaml << YAML::Key << "recording" << YAML::BeginMap;
  if (!configuration.recording_directory.empty())
    yaml << YAML::Key << "directory" << configuration.recording_directory.string();
  yaml << YAML::Key << "start" << nameOf(configuration.recording_start, kRecordingStarts);
  yaml << YAML::Key << "maximum_size" << static_cast<double>(quota.maximum_bytes) / kGigabyte;
  if (quota.maximum_age.count() > 0)
    yaml << YAML::Key << "maximum_age" << static_cast<double>(quota.maximum_age.count()) / kDay;
  yaml << YAML::Key << "keep_free" << static_cast<double>(quota.keep_free_bytes) / kGigabyte << YAML::EndMap;
}

void emitPage(YAML::Emitter& yaml, const PageConfiguration& page) {
  if (!page.listen && !page.hasToken()) return;
  yaml << YAML::Key << "page" << YAML::BeginMap;
  if (page.listen) yaml << YAML::Key << "listen" << page.listen->text();
  if (!page.token_file.empty()) yaml << YAML::Key << "token_file" << page.token_file.string();
  if (!page.token_credential.empty()) yaml << YAML::Key << "token_credential" << page.token_credential;
  yaml << YAML::EndMap;
}

/// Numbers of nine digits: 3, not 3.0000000000000004.
void emitAlertLimits(YAML::Emitter& yaml, const pipeline::AlertLimits& limits) {
  const auto emit = [&yaml](const char* key, double value) {
    yaml << YAML::Key << key << fmt::format("{:.9g}", value);
  };
  yaml << YAML::Key << "alert_limits" << YAML::BeginMap;
  emit("velocity", limits.velocity);
  emit("angular_rate", kDegreesPerRadian * limits.angular_rate);
  emit("motion", limits.motion);
  emit("rotation", kDegreesPerRadian * limits.rotation);
  yaml << YAML::EndMap;
}

double seconds(std::chrono::milliseconds duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

std::string effectiveConfiguration(const Configuration& configuration) {
  YAML::Emitter yaml;
  const auto camera = [&yaml](const char* side, const CameraConfiguration& settings) {
    yaml << YAML::Key << side << YAML::BeginMap << YAML::Key << "url" << settings.url;
    if (!settings.username.empty()) yaml << YAML::Key << "username" << settings.username;
    if (!settings.password_file.empty())
      yaml << YAML::Key << "password_file" << settings.password_file.string();
    if (!settings.password_credential.empty())
      yaml << YAML::Key << "password_credential" << settings.password_credential;
    if (!settings.size.empty()) yaml << YAML::Key << "size" << sizeText(settings.size);
    if (settings.format) yaml << YAML::Key << "format" << nameOf(*settings.format, kFormats);
    if (settings.exposure) yaml << YAML::Key << "exposure" << *settings.exposure;
    if (settings.gain) yaml << YAML::Key << "gain" << *settings.gain;
    if (settings.readout) yaml << YAML::Key << "readout" << *settings.readout;
    yaml << YAML::EndMap;
  };
  yaml << YAML::BeginMap << YAML::Key << "cameras" << YAML::BeginMap;
  camera("left", configuration.left);
  camera("right", configuration.right);
  yaml << YAML::Key << "transport" << nameOf(configuration.transport, kTransports);
  yaml << YAML::Key << "authentication" << nameOf(configuration.basic_authentication, kAuthentications);
  yaml << YAML::Key << "clock" << nameOf(configuration.clock, kClocks);
  if (configuration.frame_rate) yaml << YAML::Key << "frame_rate" << *configuration.frame_rate;
  yaml << YAML::Key << "answer_timeout" << seconds(configuration.answer_timeout);
  yaml << YAML::Key << "connect_timeout" << seconds(configuration.connect_timeout);
  yaml << YAML::Key << "stall_timeout" << seconds(configuration.stall_timeout) << YAML::EndMap;
  yaml << YAML::Key << "rig" << configuration.rig.string();
  if (!configuration.tables.empty()) yaml << YAML::Key << "tables" << configuration.tables.string();
  yaml << YAML::Key << "odometry" << YAML::BeginMap << YAML::Key << "estimator"
       << nameOf(configuration.odometry.estimator, kEstimators);
  yaml << YAML::Key << "features" << configuration.odometry.features;
  yaml << YAML::Key << "seed" << configuration.odometry.seed;
  yaml << YAML::Key << "online_rig_refinement"
       << nameOf(configuration.odometry.rig_refinement, kRigRefinements);
  yaml << YAML::Key << "maximum_offset"  // shortest: 0.1, not 0.10000000000000001
       << fmt::format("{}", configuration.odometry.validity.maximum_offset);
  yaml << YAML::Key << "maximum_offset_uncertainty"
       << configuration.odometry.validity.maximum_offset_uncertainty;
  emitAlertLimits(yaml, configuration.alert_limits);
  yaml << YAML::Key << "threads" << configuration.threads << YAML::EndMap;
  yaml << YAML::Key << "lcm" << YAML::BeginMap << YAML::Key << "url" << configuration.lcm_url;
  yaml << YAML::Key << "time_to_live" << seconds(configuration.time_to_live);
  if (!configuration.pose_channel.empty()) {
    yaml << YAML::Key << "pose_channel" << configuration.pose_channel;
    yaml << YAML::Key << "pose_velocity" << nameOf(configuration.pose_velocity, kPoseVelocities);
  }
  yaml << YAML::EndMap;
  emitRecording(yaml, configuration);
  if (configuration.metrics) {
    yaml << YAML::Key << "metrics" << YAML::BeginMap << YAML::Key << "listen" << configuration.metrics->text()
         << YAML::EndMap;
  }
  emitPage(yaml, configuration.page);
  yaml << YAML::Key << "logging" << YAML::BeginMap << YAML::Key << "level"
       << nameOf(configuration.log_level, kLogLevels);
  yaml << YAML::EndMap << YAML::EndMap;
  return std::string(yaml.c_str()) + "\n";
}

}  // namespace cartvo::daemon
