#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "capture/encoded_unit.hpp"
#include "capture/rtsp/access_unit_assembler.hpp"
#include "capture/rtsp/rtsp_camera.hpp"

// One RTSP connection. Internal to RtspCamera.

namespace cartvo::capture {

/// Error while opening a connection. The text names the camera, but not its password.
class RtspError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t { unreachable, refused, interrupted };
  RtspError(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// One RTSP connection to a camera. Every call that may block has a deadline.
class RtspSession {
 public:
  using Clock = std::chrono::steady_clock;

  /// Result of `receive`.
  enum class Outcome : std::uint8_t { fragment, timed_out, lost, interrupted };

  /// Connects and starts the stream, within `settings.connect_timeout`. `interrupted` aborts it, and every
  /// later call, within 0.1 s; it must outlive the session. Throws RtspError.
  RtspSession(const RtspCameraSettings& settings, const std::atomic<bool>& interrupted);
  ~RtspSession();
  RtspSession(const RtspSession&) = delete;
  RtspSession& operator=(const RtspSession&) = delete;

  const StreamFormat& format() const;

  /// Waits for the next RTP packet of the video stream. `fragment.data` is valid until the next call. After
  /// any other outcome than `fragment` the session must not be used further.
  Outcome receive(StreamFragment& fragment, Clock::time_point deadline);

  /// Reason for the outcome `lost`, for messages.
  const std::string& reason() const;

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

/// Throws std::invalid_argument, without repeating the URL, unless it is "rtsp://host[:port]/path" without
/// user, password or white space.
void checkRtspUrl(const std::string& url);

/// The URL's "host[:port]".
std::string rtspHost(const std::string& url);

}  // namespace cartvo::capture
