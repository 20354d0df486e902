// Camera source that keeps only the newest frame of a live camera.
#include "tools/calibrate/views/newest_frame.hpp"

#include <utility>

namespace cartvo {

NewestFrame::NewestFrame(capture::CameraSource& camera) : camera_(camera), reader_([this] { readAll(); }) {}

NewestFrame::~NewestFrame() {
  camera_.interrupt();
  reader_.join();
}

void NewestFrame::readAll() {
  constexpr std::chrono::milliseconds kTimeout{500};
  capture::ReadOutcome outcome = capture::ReadOutcome::timed_out;
  while (outcome != capture::ReadOutcome::ended) {
    capture::Frame frame;
    outcome = camera_.read(frame, kTimeout);
    const std::lock_guard lock(mutex_);
    if (outcome == capture::ReadOutcome::frame && frame.status == capture::FrameStatus::good) {
      newest_ = std::move(frame);
      is_new_ = true;
    }
    ended_ = outcome == capture::ReadOutcome::ended;
    changed_.notify_all();
  }
}

capture::ReadOutcome NewestFrame::read(capture::Frame& frame, std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [this] { return is_new_ || ended_; });
  if (!is_new_) return ended_ ? capture::ReadOutcome::ended : capture::ReadOutcome::timed_out;
  frame = std::move(newest_);
  is_new_ = false;
  return capture::ReadOutcome::frame;
}

}  // namespace cartvo
