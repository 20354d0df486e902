#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "tools/simulate/encoded_stream.hpp"

namespace cartvo::simulate {

struct SimulatedCameraSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: one that is free
  std::string user = "admin";
  std::string password;  ///< asked for by Digest authentication; never empty
  std::int64_t switched_on_ns =
      0;  ///< the instants of the lead-in are counted from here (Unix epoch); 0: now
  std::chrono::nanoseconds latency{0};  ///< from a picture's exposure to its sending
  std::int64_t repeat_after_ns = 0;     ///< length of one turn of the content if it is repeated; 0: it ends
};

/// An IP camera as the real ones behave: an RTSP server (GStreamer's) with Digest authentication that sends
/// H.264 in real time over TCP or UDP, and RTCP sender reports that relate its RTP clock to the instants of
/// exposure. Sends its lead-in until `startContent`. Any number of clients; each
/// begins at a key frame, may leave and may return.
class SimulatedCamera {
 public:
  /// Listens and sends from now on. Throws std::runtime_error if it cannot listen there,
  /// std::invalid_argument for an empty stream or password.
  SimulatedCamera(std::shared_ptr<const EncodedStream> stream, const SimulatedCameraSettings& settings);

  /// Disconnects every client and frees the port.
  ~SimulatedCamera();
  SimulatedCamera(const SimulatedCamera&) = delete;
  SimulatedCamera& operator=(const SimulatedCamera&) = delete;

  std::uint16_t port() const;

  /// rtsp://ADDRESS:PORT/Streaming/Channels/101; no credentials.
  std::string url() const;

  /// The content's instant 0 becomes `epoch_ns` (ns since the Unix epoch). Only the first call counts.
  void startContent(std::int64_t epoch_ns);

  /// Clients that have said PLAY and are still there.
  int playingClients() const;

  /// Whether the content's last picture was sent. The clients were told so (RTCP BYE).
  bool finished() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::simulate
