// V4L2 camera as a frame source that reopens its device after errors.

#include "capture/v4l2/v4l2_camera.hpp"

#include <algorithm>
#include <atomic>
#include <ctime>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "capture/stream_remarks.hpp"
#include "capture/v4l2/v4l2_device.hpp"
#include "common/host_clock.hpp"
#include "common/threads/wake_event.hpp"

namespace cartvo::capture {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Remark = StreamRemarks::Kind;

constexpr const char* kBusRemedy =
    ": the USB bus may lose data; connect the cameras to different USB controllers or set a lower "
    "cameras.frame_rate";

void validate(const V4l2CameraSettings& settings) {
  if (settings.device.empty() || settings.size.empty() || !(settings.frame_rate > 0.0))
    throw std::invalid_argument("a V4L2 camera needs a device, a size and a positive frame rate");
  if (settings.stall_timeout.count() <= 0 || settings.frozen_after.count() <= 0 ||
      settings.retry.count() <= 0)
    throw std::invalid_argument("a camera's time-outs must be positive");
}

}  // namespace

/// Implementation of V4l2Camera: opens, waits and reopens in the thread that calls `read`.
class V4l2Camera::Receiver {
 public:
  explicit Receiver(const V4l2CameraSettings& settings) : settings_(settings) {
    validate(settings_);
    health_.instant_source = InstantSource::kernel;
  }

  ReadOutcome read(Frame& frame, milliseconds timeout) {
    const Clock::time_point deadline = Clock::now() + timeout;
    for (;;) {
      if (interrupted_) return finish();
      if (!device_) {
        wake_.waitUntil(std::min(next_attempt_, deadline));
        if (!interrupted_ && Clock::now() >= next_attempt_) open();
      } else if (receive(frame, deadline)) {
        return ReadOutcome::frame;
      }
      if (interrupted_) return finish();
      if (Clock::now() >= deadline) return ReadOutcome::timed_out;
    }
  }

  CameraHealth health() const {
    const std::lock_guard lock(mutex_);
    return health_;
  }

  void interrupt() noexcept {
    interrupted_ = true;
    wake_.wake();
  }

 private:
  void open() {
    const V4l2Mode mode{settings_.size, settings_.frame_rate, settings_.format, settings_.exposure,
                        settings_.gain};
    try {
      device_.emplace(settings_.device, mode);
    } catch (const V4l2Error& error) {
      next_attempt_ = Clock::now() + settings_.retry;
      const std::lock_guard lock(mutex_);
      health_.state = CameraState::connecting;
      health_.last_error = error.what();
      return;
    }
    last_driver_sequence_.reset();
    incomplete_ = 0;
    frame_deadline_ = Clock::now() + settings_.stall_timeout;
    remarks_.emplace();
    const std::lock_guard lock(mutex_);
    health_.advice.clear();
  }

  bool receive(Frame& frame, Clock::time_point deadline) {
    try {
      const auto buffer = device_->dequeue(std::min(deadline, frame_deadline_), wake_.descriptor());
      if (buffer) return toFrame(*buffer, frame);
    } catch (const V4l2Error& error) {
      closeDevice(CameraState::connecting, error.what());
      return false;
    }
    if (!interrupted_ && Clock::now() >= frame_deadline_)
      closeDevice(CameraState::stalled, "the camera " + settings_.device.string() + " sent no picture for " +
                                            std::to_string(settings_.stall_timeout.count()) + " ms" +
                                            incompleteText() + "; reopening it");
    return false;
  }

  std::string incompleteText() const {
    if (incomplete_ == 0) return "";
    return " but " + std::to_string(incomplete_) + " incomplete ones or of another size" + kBusRemedy;
  }

  /// Says how many pictures were left out since the camera was opened.
  void noteRemarks(std::uint64_t missed, bool is_incomplete) {
    if (missed > 0) remarks_->setTotal(Remark::missed, remarks_->count(Remark::missed) + missed);
    if (is_incomplete) remarks_->add(Remark::incomplete);
    if (remarks_->text().empty()) return;
    const std::lock_guard lock(mutex_);
    health_.advice = "left out of what the camera " + settings_.device.string() +
                     " sends: " + remarks_->text() + kBusRemedy;
  }

  /// Converts a buffer to a frame. False if it contains no valid picture, which counts as a damaged one.
  bool toFrame(const V4l2Buffer& buffer, Frame& frame) {
    const std::int64_t arrival_ns = hostNow();
    // Some drivers do not count their pictures, or begin anew.
    const bool goes_on = last_driver_sequence_ && buffer.sequence > *last_driver_sequence_;
    const std::uint64_t missed = goes_on ? buffer.sequence - *last_driver_sequence_ - 1U : 0U;
    next_sequence_ += missed;
    last_driver_sequence_ = buffer.sequence;
    const std::uint64_t sequence = next_sequence_++;
    Frame received;
    received.image = toGreyImage(device_->format(), buffer.data, settings_.size, device_->stride());
    noteRemarks(missed, received.image.empty() || buffer.damaged);
    if (received.image.empty()) {
      ++incomplete_;
      const std::lock_guard lock(mutex_);
      ++health_.frames, ++health_.damaged;
      return false;
    }
    incomplete_ = 0;
    frame_deadline_ = Clock::now() + settings_.stall_timeout;
    received.exposure_ns = hostTimeOfMonotonic(buffer.monotonic.count());
    received.exposure_stddev_ns = defaultStddevNs(InstantSource::kernel);
    received.min_delay_arrival_ns = received.exposure_ns;
    received.arrival_ns = arrival_ns;
    received.decoded_ns = hostNow();
    received.sequence = sequence;
    received.status = buffer.damaged ? FrameStatus::damaged : FrameStatus::good;
    received.instant_source = InstantSource::kernel;
    updateHealth(received);
    frame = std::move(received);
    return true;
  }

  void updateHealth(const Frame& frame) {
    const bool frozen = frozen_detector_.update(frame.image, Clock::now()) >= settings_.frozen_after;
    const std::lock_guard lock(mutex_);
    health_.state = frozen ? CameraState::frozen : CameraState::streaming;
    if (frozen)
      health_.last_error = "the camera " + settings_.device.string() +
                           " is frozen: it repeats the same picture; unplug it and plug it in again";
    ++health_.frames;
    if (frame.status == FrameStatus::damaged) ++health_.damaged;
  }

  void closeDevice(CameraState state, const std::string& reason) {
    device_.reset();
    next_attempt_ = Clock::now() + settings_.retry;
    const std::lock_guard lock(mutex_);
    health_.state = state;
    health_.last_error = reason;
    ++health_.reconnections;
  }

  ReadOutcome finish() {
    device_.reset();
    const std::lock_guard lock(mutex_);
    health_.state = CameraState::ended;
    return ReadOutcome::ended;
  }

  const V4l2CameraSettings settings_;
  WakeEvent wake_;
  std::atomic<bool> interrupted_ = false;

  // Used by the reading thread only.
  std::optional<V4l2Device> device_;
  FrozenPictureDetector frozen_detector_;
  Clock::time_point frame_deadline_;
  Clock::time_point next_attempt_;
  std::optional<std::uint32_t> last_driver_sequence_;
  std::uint64_t next_sequence_ = 0;
  std::uint64_t incomplete_ = 0;          ///< pictures since the last one that could be decoded
  std::optional<StreamRemarks> remarks_;  ///< since the device was opened

  mutable std::mutex mutex_;  ///< guards health_
  CameraHealth health_;
};

V4l2Camera::V4l2Camera(const V4l2CameraSettings& settings)
    : receiver_(std::make_unique<Receiver>(settings)) {}
V4l2Camera::~V4l2Camera() = default;

ReadOutcome V4l2Camera::read(Frame& frame, milliseconds timeout) {
  return receiver_->read(frame, timeout);
}
CameraHealth V4l2Camera::health() const {
  return receiver_->health();
}
void V4l2Camera::interrupt() noexcept {
  receiver_->interrupt();
}

}  // namespace cartvo::capture
