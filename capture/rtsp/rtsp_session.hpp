#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "capture/encoded_unit.hpp"
#include "capture/rtsp/access_unit_assembler.hpp"
#include "capture/rtsp/rtsp_camera.hpp"
#include "capture/rtsp/rtsp_client.hpp"
#include "capture/stream_remarks.hpp"

// One RTSP connection. Internal to RtspCamera.

namespace cartvo::capture {

/// One RTSP connection to a camera and its RTP stream, over TCP or UDP. Every call that may block has a
/// deadline. An own client rather than FFmpeg's, because timing and loss need what that hides: the packets'
/// arrival, sequence numbers and marker bits, and the sender reports.
class RtspSession {
 public:
  using Clock = std::chrono::steady_clock;

  /// Result of `receive`.
  enum class Outcome : std::uint8_t { fragment, timed_out, lost, interrupted };

  /// Connects and starts the stream, within `settings.connect_timeout`. `interrupted` aborts it, and every
  /// later call, within 0.1 s; both must outlive the session. Throws RtspError.
  RtspSession(const RtspCameraSettings& settings, const std::atomic<bool>& interrupted);
  ~RtspSession();
  RtspSession(const RtspSession&) = delete;
  RtspSession& operator=(const RtspSession&) = delete;

  const StreamFormat& format() const;

  /// Waits for the next RTP packet of the video stream. `fragment.data` is valid until the next call. After
  /// any other outcome than `fragment` the session must not be used further.
  Outcome receive(StreamFragment& fragment, Clock::time_point deadline);

  /// Counters of what the camera sends and is left out. The user of the packets adds what it leaves out.
  StreamRemarks& remarks();

  /// Reason for the outcome `lost`, for messages.
  const std::string& reason() const;

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace cartvo::capture
