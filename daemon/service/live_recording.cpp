// Recording of the daemon's cameras: start, stop, problems, and requests to switch it.
#include "daemon/service/live_recording.hpp"

#include <cerrno>
#include <chrono>
#include <ctime>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/chrono.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "calib/format/rig_file.hpp"
#include "daemon/diagnostics/journal.hpp"

namespace cartvo::daemon {
namespace {

/// Of --record, which asks for one recording, in a new folder.
bool isOfRecordOption(const Configuration& configuration) {
  return configuration.recording_quota.recordings.empty();
}

/// Why these cameras cannot be recorded; empty: they can.
std::string cameraObstacle(const Configuration& configuration) {
  if (configuration.left.isV4l2() || configuration.right.isV4l2())
    return "only IP cameras can be recorded, because V4L2 cameras send no encoded video";
  return {};
}

void logRecording(spdlog::level::level_enum level, const std::string& text, const char* event) {
  logEvent(level, text, {{"CARTVO_EVENT", "recording"}, {"CARTVO_RECORDING", event}});
}

}  // namespace

/// Passes one camera's stream to the current recorder, in the camera's thread. A recorder that begins within
/// a connection gets the connection's format first.
class RecordingSwitch::Side final : public capture::StreamObserver {
 public:
  using Observer = capture::StreamObserver& (capture::StreamRecorder::*)();
  explicit Side(Observer side) : side_(side) {}

  void set(const OpenRecording& recording) { news_.put(std::make_unique<OpenRecording>(recording)); }

  void onStream(const capture::StreamFormat& format) noexcept override {
    format_ = format;
    if (!takeNews() && recorder_) (*recorder_.*side_)().onStream(format);
  }
  void onUnit(const capture::EncodedUnit& unit) noexcept override {
    takeNews();
    if (recorder_) (*recorder_.*side_)().onUnit(unit);
  }

 private:
  bool takeNews() {
    const std::unique_ptr<OpenRecording> news = news_.take();
    if (!news) return false;
    recorder_ = news->recorder;
    if (recorder_ && format_) (*recorder_.*side_)().onStream(*format_);
    return true;
  }

  Observer side_;
  Mailbox<OpenRecording> news_;
  std::shared_ptr<capture::StreamRecorder> recorder_;
  std::optional<capture::StreamFormat> format_;  ///< of the connection
};

RecordingSwitch::RecordingSwitch()
    : left_(std::make_unique<Side>(&capture::StreamRecorder::left)),
      right_(std::make_unique<Side>(&capture::StreamRecorder::right)) {}
RecordingSwitch::~RecordingSwitch() = default;

capture::StreamObserver& RecordingSwitch::left() {
  return *left_;
}
capture::StreamObserver& RecordingSwitch::right() {
  return *right_;
}

bool RecordingSwitch::start(const capture::RecordingSettings& settings) {
  const std::lock_guard lock(mutex_);
  if (open_.recorder) return false;
  open_ = {std::make_shared<capture::StreamRecorder>(settings), settings.folder};
  tell(open_);
  return true;
}

bool RecordingSwitch::stop() {
  const std::lock_guard lock(mutex_);
  if (!open_.recorder) return false;
  tell({nullptr, open_.folder});
  open_.recorder->finish();
  open_.recorder.reset();
  return true;
}

void RecordingSwitch::tell(const OpenRecording& recording) {
  left_->set(recording);
  right_->set(recording);
  news_.put(std::make_unique<OpenRecording>(recording));
}

const OpenRecording& RecordingSwitch::current() {
  if (std::unique_ptr<OpenRecording> news = news_.take()) current_ = std::move(*news);
  return current_;
}

std::string recordingFolderName() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H-%M-%SZ}", fmt::gmtime(now));
}

std::string recordingObstacle(const Configuration& configuration) {
  if (configuration.recording_directory.empty()) return {};
  std::error_code ignored;
  std::filesystem::path folder = configuration.recording_directory;
  if (isOfRecordOption(configuration)) {
    if (std::string obstacle = cameraObstacle(configuration); !obstacle.empty()) return obstacle;
    std::error_code error;
    if (std::filesystem::is_directory(folder, ignored) && !std::filesystem::is_empty(folder, error) && !error)
      return folder.string() + ": is not empty; give --record a new folder";
  }
  while (!std::filesystem::exists(folder, ignored) && folder.has_relative_path())
    folder = folder.parent_path();
  const std::string purpose = ": recordings are to be written here, but it ";
  if (!std::filesystem::is_directory(folder, ignored)) return folder.string() + purpose + "is no folder";
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    return folder.string() + purpose + "is not writable: " + std::generic_category().message(errno);
  return {};
}

void LiveRecording::observe(LiveCamera& left, LiveCamera& right) {
  if (configuration_.recording_directory.empty()) return;
  left.observe(switch_.left());
  right.observe(switch_.right());
  if (configuration_.recording_start == RecordingStart::automatic)
    refused_ = startIn(configuration_.recording_directory);
  if (isOfRecordOption(configuration_) && !refused_.empty())
    throw std::runtime_error("cartvod ends, because --record asks for a recording that cannot be made");
}

capture::RecordingSettings LiveRecording::settings() const {
  capture::RecordingSettings settings;
  settings.configuration = effectiveConfiguration(configuration_);
  settings.rig = calib::portableRigText(configuration_.rig);
  settings.quota = configuration_.recording_quota;
  return settings;
}

std::string LiveRecording::startIn(const std::filesystem::path& folder) {
  std::string problem = cameraObstacle(configuration_);
  try {
    if (problem.empty()) {
      capture::RecordingSettings settings = this->settings();
      settings.folder = folder;
      if (!switch_.start(settings)) return "already recording";
      logRecording(spdlog::level::info, "recording to " + folder.string(), "started");
      return {};
    }
  } catch (const std::exception& error) {
    problem = error.what();
  }
  problem = "not recording: " + problem;
  logRecording(spdlog::level::err, problem, "refused");
  return problem;
}

std::string LiveRecording::start() {
  if (configuration_.recording_directory.empty())
    return "recording.directory is not configured: there is no folder to record to";
  if (isOfRecordOption(configuration_)) return "cartvod runs with --record, which makes one recording";
  return startIn(configuration_.recording_quota.recordings / recordingFolderName());
}

std::string LiveRecording::stop() {
  if (!switch_.stop()) return "nothing is being recorded";
  logRecording(spdlog::level::info, "recording stopped from the status page", "stopped");
  return {};
}

std::string LiveRecording::problem(RepeatedWarnings& warnings) {
  const OpenRecording& open = switch_.current();
  if (!open.recorder) return open.folder.empty() ? refused_ : "";
  const capture::RecorderHealth health = open.recorder->health();
  if (health.resumptions > std::exchange(resumptions_, health.resumptions))
    logRecording(spdlog::level::info,
                 "recording again, in a new segment in " + open.folder.string() + "; so far " +
                     std::to_string(health.missing_pictures) + " pictures are missing",
                 "resumed");
  if (health.error.empty()) warnings.forget(error_);
  error_ = health.error;
  if (!health.error.empty()) return health.error;
  const bool drops_pictures =
      health.dropped_pictures > std::exchange(dropped_pictures_, health.dropped_pictures);
  return drops_pictures ? "the disk is too slow for the recording: pictures are left out of it" : "";
}

RecordingState LiveRecording::state() {
  RecordingState state;
  const OpenRecording& open = switch_.current();
  state.is_possible = !isOfRecordOption(configuration_) && cameraObstacle(configuration_).empty();
  state.folder = open.folder.string();
  state.is_recording = open.recorder != nullptr;
  if (configuration_.recording_directory.empty()) {
    state.text = "No folder is configured (recording.directory).";
  } else if (!open.recorder && open.folder.empty()) {
    state.text = refused_;
  }
  if (!open.recorder) return state;
  const capture::RecorderHealth health = open.recorder->health();
  state.text = health.error;
  state.pictures = health.units;
  state.bytes = health.bytes;
  state.dropped_pictures = health.dropped_pictures;
  return state;
}

}  // namespace cartvo::daemon
