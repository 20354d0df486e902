// Camera source that keeps only the newest frame of a live camera.
#include "tools/calibrate/views/newest_frame.hpp"

#include <utility>

namespace cartvo {

NewestFrame::NewestFrame(CameraSource& camera) : camera_(camera), reader_([this] { readAll(); }) {}

NewestFrame::~NewestFrame() {
  camera_.interrupt();
  reader_.join();
}

void NewestFrame::readAll() {
  constexpr std::chrono::milliseconds kTimeout{500};
  ReadOutcome outcome = ReadOutcome::timed_out;
  while (outcome != ReadOutcome::ended) {
    Frame frame;
    outcome = camera_.read(frame, kTimeout);
    const std::lock_guard lock(mutex_);
    if (outcome == ReadOutcome::frame && frame.status == FrameStatus::good) {
      newest_ = std::move(frame);
      is_new_ = true;
    }
    ended_ = outcome == ReadOutcome::ended;
    changed_.notify_all();
  }
}

ReadOutcome NewestFrame::read(Frame& frame, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return is_new_ || ended_; });
  if (!is_new_) return ended_ ? ReadOutcome::ended : ReadOutcome::timed_out;
  frame = std::move(newest_);
  is_new_ = false;
  return ReadOutcome::frame;
}

}  // namespace cartvo
