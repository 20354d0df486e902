#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "capture/camera_source.hpp"
#include "capture/clock/stereo_timestamper.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/network/credentials.hpp"

// Frame source for an IP camera over RTSP.

namespace cartvo::capture {

/// Transport of the RTP packets.
enum class RtspTransport : std::uint8_t { tcp, udp };

/// Statement of a camera about a login that it refused.
struct RefusedLogin {
  std::optional<std::chrono::milliseconds>
      locked_for;    ///< until it accepts a login again; nothing: not known
  std::string text;  ///< printable, for messages; may be empty
};

/// Settings of one IP camera.
struct RtspCameraSettings {
  std::string url;  ///< rtsp://host[:port]/path, without credentials
  Credentials credentials;
  RtspTransport transport = RtspTransport::tcp;
  bool basic_authentication = false;  ///< allow Basic, which sends the password readably

  std::chrono::milliseconds answer_timeout{1000};   ///< limit for the TCP connection
  std::chrono::milliseconds connect_timeout{5000};  ///< limit from the TCP connection to the first frame
  std::chrono::milliseconds stall_timeout{1000};    ///< limit without a frame; then reconnects
  std::chrono::milliseconds frozen_after{
      5000};  ///< duration of an unchanged picture until CameraState::frozen

  // A camera that is available again is connected to within answer_timeout + longest_retry.
  std::chrono::milliseconds first_retry{250};    ///< pause before the first reconnection; doubles every time
  std::chrono::milliseconds longest_retry{500};  ///< limit of that pause

  /// Pause after a refused password; doubles every time. Cameras lock an account after a few wrong passwords.
  std::chrono::milliseconds refused_retry{30000};
  std::chrono::milliseconds longest_refused_retry{30 * 60 * 1000};

  /// Asks the camera about a refused login, without a password. A lock that the answer states lengthens the
  /// pause to that time, at most 2 h. Must not throw, and return within `answer_timeout`, or within a second
  /// once the flag is true. Empty: not asked.
  std::function<RefusedLogin(const std::atomic<bool>& interrupted)> ask_about_refusal{};

  std::int64_t max_pixels = 64'000'000;  ///< larger pictures are refused

  int decoder_threads =
      1;  ///< slice threads; frame threads are not used, because each adds a frame of latency
};

/// Throws std::invalid_argument if the URL is none of a camera, or if a setting is out of range.
void checkSettings(const RtspCameraSettings& settings);

/// One IP camera over RTSP (RFC 2326), H.264 or H.265. Connects, and reconnects without limit. Has no thread:
/// `read` receives and decodes in the caller's thread.
///
/// `read` checks its time-out between packets. On a stalled connection it takes up to `stall_timeout`; while
/// connecting, up to `answer_timeout` plus `connect_timeout`, after a refused login another `answer_timeout`.
/// `interrupt` takes effect within 0.1 s, while a camera is asked about a refused login within a second.
class RtspCamera : public CameraSource {
 public:
  /// Validates the settings; the first `read` connects. Throws std::invalid_argument if the URL is not an
  /// RTSP URL or contains credentials (the message does not repeat them), or if a setting is out of range.
  explicit RtspCamera(const RtspCameraSettings& settings);
  ~RtspCamera() override;
  RtspCamera(const RtspCamera&) = delete;
  RtspCamera& operator=(const RtspCamera&) = delete;

  /// Passes everything received to `observer`, which must outlive the camera. Call before the first `read`.
  void setObserver(StreamObserver& observer);

  /// Timestamps the pictures by `timestamper`, as the given side of the pair. It must outlive the camera.
  /// Without this call the camera uses a timestamper of its own. Call before the first `read`.
  void setTimestamper(StereoTimestamper& timestamper, CameraSide side);

  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

 private:
  class Receiver;
  std::unique_ptr<Receiver> receiver_;
};

}  // namespace cartvo::capture
