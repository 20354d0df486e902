#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "capture/camera_source.hpp"
#include "capture/credentials.hpp"
#include "capture/encoded_unit.hpp"
#include "capture/pair_clock.hpp"

namespace cartvo {

enum class RtspTransport : std::uint8_t { tcp, udp };

struct RtspCameraSettings {
  std::string url;  ///< rtsp://host[:port]/path, without credentials
  Credentials credentials;
  RtspTransport transport = RtspTransport::tcp;

  std::chrono::milliseconds answer_timeout{1000};   ///< for the camera to accept a connection at all
  std::chrono::milliseconds connect_timeout{5000};  ///< from then on to the first frame received
  std::chrono::milliseconds stall_timeout{1000};  ///< without a frame for so long, the connection is given up
  std::chrono::milliseconds frozen_after{5000};   ///< the same picture for so long is a fault to be told

  // A camera that comes back is met within the answer's time-out and the longest pause.
  std::chrono::milliseconds first_retry{250};    ///< pause before the first reconnection; doubles each time
  std::chrono::milliseconds longest_retry{500};  ///< bound of that pause

  /// Pause after a refused password; doubles each time. Cameras lock an account after a few wrong ones.
  std::chrono::milliseconds refused_retry{30000};
  std::chrono::milliseconds longest_refused_retry{30 * 60 * 1000};

  int decoder_threads = 1;  ///< slice threads; never frame threads, which add a frame of latency each
};

/// One IP camera over RTSP (RFC 2326), H.264 or H.265. Connects, and reconnects for ever. No thread of its
/// own: `read` receives and decodes in the caller's thread.
///
/// `read` looks at its timeout between packets, so on a connection that has fallen silent it takes up to
/// `stall_timeout`, and up to `answer_timeout` and `connect_timeout` while a connection is being opened.
/// `interrupt` is heeded within 0.1 s.
class RtspCamera : public CameraSource {
 public:
  /// Checks the settings only; the first `read` connects. Throws std::invalid_argument for a URL that is not
  /// RTSP's, holds credentials (the message does not repeat them), or settings that make no sense.
  explicit RtspCamera(const RtspCameraSettings& settings);
  ~RtspCamera() override;
  RtspCamera(const RtspCamera&) = delete;
  RtspCamera& operator=(const RtspCamera&) = delete;

  /// Hands everything received to `observer`, which must outlive the camera. Call before the first `read`.
  void observe(StreamObserver& observer);

  /// Stamps the pictures as that side of a pair, by `clock`, which must outlive the camera. Else they are
  /// stamped by a clock of their own. Call before the first `read`.
  void share(PairClock& clock, CameraSide side);

  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

 private:
  class Receiver;
  std::unique_ptr<Receiver> receiver_;
};

}  // namespace cartvo
