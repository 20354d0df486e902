#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "capture/frame.hpp"

// Interface of all sources of frames, live or recorded.

namespace cartvo::capture {

/// Result of waiting for a frame.
enum class ReadOutcome : std::uint8_t {
  frame,      ///< a frame was delivered
  timed_out,  ///< no frame within the time-out; the source keeps trying
  ended,      ///< there will be no further frame
};

/// State of a camera, for health reports: in the order of camera_health_t's constants.
enum class CameraState : std::uint8_t {
  connecting,
  streaming,
  stalled,
  refused,
  ended,
  frozen,  ///< packets arrive, but the picture does not change
};

/// Snapshot of one camera's health. Contains no credentials.
struct CameraHealth {
  CameraState state = CameraState::connecting;
  InstantSource instant_source = InstantSource::file;
  std::uint64_t frames = 0;         ///< received since the start
  std::uint64_t damaged = 0;        ///< of these, marked FrameStatus::damaged or not decodable
  std::uint64_t reconnections = 0;  ///< times the stream had to be opened again
  std::string last_error;           ///< what is wrong and what to do; empty if there was no error
  std::string advice;               ///< what to change about a camera that streams; empty if nothing
};

/// One camera as a sequence of frames in the order of their exposure. One thread reads; `health` and
/// `interrupt` may be called from any other.
class CameraSource {
 public:
  virtual ~CameraSource() = default;

  /// Waits for the next frame, up to `timeout`, or longer up to a bound that the source documents
  /// (RtspCamera: its time-outs, plus decoding). Never blocks for ever, whatever the camera does. Files are
  /// read without waiting.
  virtual ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) = 0;

  virtual CameraHealth health() const = 0;

  /// Makes a `read` in progress, and each later one, return `ended` at once (RtspCamera: within 0.1 s).
  virtual void interrupt() noexcept = 0;
};

}  // namespace cartvo::capture
