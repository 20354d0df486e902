// Starts and stops recordings while the cameras stream.
#include "daemon/service/recording_switch.hpp"

#include <utility>

namespace cartvo::daemon {

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

}  // namespace cartvo::daemon
