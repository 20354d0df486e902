#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "capture/frame.hpp"

namespace cartvo {

/// What came of waiting for a frame.
enum class ReadOutcome : std::uint8_t {
  frame,      ///< a frame was delivered
  timed_out,  ///< nothing within the time given; the source goes on trying
  ended,      ///< there will never be another one
};

/// What a camera is doing, for health reports.
enum class CameraState : std::uint8_t {
  connecting,
  streaming,
  stalled,
  refused,
  ended,
  frozen,  ///< packets flow, but the picture never changes
};

/// A snapshot of one camera's condition. Holds no credentials.
struct CameraHealth {
  CameraState state = CameraState::connecting;
  InstantSource instant_source = InstantSource::file;
  std::uint64_t frames = 0;         ///< delivered since the start
  std::uint64_t damaged = 0;        ///< of these, marked FrameStatus::damaged
  std::uint64_t reconnections = 0;  ///< times the stream had to be opened again
  std::string last_error;           ///< a sentence that a person can act on; empty if there was none
};

/// One camera as a sequence of frames in the order of their exposure. One thread reads; `health` and
/// `interrupt` may be called from any other.
class CameraSource {
 public:
  virtual ~CameraSource() = default;

  /// Waits for the next frame, up to `timeout`, or longer up to a bound that the source states (RtspCamera:
  /// its time-outs; a decoder's time aside). Never for ever, whatever the camera does. Files are read without
  /// waiting.
  virtual ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) = 0;

  virtual CameraHealth health() const = 0;

  /// Makes a `read` in progress, and each later one, return `ended` at once
  /// (RtspCamera: within 0.1 s).
  virtual void interrupt() noexcept = 0;
};

}  // namespace cartvo
