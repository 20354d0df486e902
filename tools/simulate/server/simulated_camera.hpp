#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::simulate {

/// Settings of one simulated camera.
struct SimulatedCameraSettings {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any free port
  std::string user = "admin";
  std::string password;                 ///< for Digest authentication; must not be empty
  std::int64_t switched_on_ns = 0;      ///< start of the lead-in, ns since the Unix epoch; 0: now
  std::chrono::nanoseconds latency{0};  ///< from the exposure of a picture to its sending
  std::int64_t repeat_after_ns = 0;     ///< period of the content if it is repeated; 0: it ends
};

/// A simulated IP camera: an RTSP server (GStreamer) with Digest authentication that sends H.264 in real time
/// over TCP or UDP, with RTCP sender reports that relate its RTP clock to exposures. Sends its lead-in until
/// startContent(). Any number of clients may connect, disconnect and reconnect; each starts at a key frame.
class SimulatedCamera {
 public:
  /// Starts to listen and to send. Throws std::runtime_error if it cannot listen on the address and port,
  /// std::invalid_argument for an empty stream or password.
  SimulatedCamera(std::shared_ptr<const EncodedStream> stream, const SimulatedCameraSettings& settings);

  /// Disconnects every client and frees the port.
  ~SimulatedCamera();
  SimulatedCamera(const SimulatedCamera&) = delete;
  SimulatedCamera& operator=(const SimulatedCamera&) = delete;

  std::uint16_t port() const;

  /// rtsp://ADDRESS:PORT/Streaming/Channels/101, without credentials.
  std::string url() const;

  /// Sets the system time of content instant 0, ns since the Unix epoch. Only the first call has an effect.
  void startContent(std::int64_t epoch_ns);

  /// Number of connected clients that have sent PLAY.
  int playingClients() const;

  /// Whether the last picture of the content was sent; clients have then received RTCP BYE.
  bool isFinished() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::simulate
