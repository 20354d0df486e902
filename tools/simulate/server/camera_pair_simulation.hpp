#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "tools/simulate/server/simulated_camera.hpp"
#include "tools/simulate/stream/encoded_stream.hpp"

namespace cartvo::simulate {

/// Condition for the start of the content.
enum class ContentStart : std::uint8_t {
  at_once,       ///< one lead-in after the cameras are switched on
  when_watched,  ///< one lead-in after clients play both cameras
};

/// Behaviour at the end of the content.
enum class ContentEnd : std::uint8_t { stop, repeat };

/// Address and port of a camera's RTSP server.
struct Endpoint {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any free port
};

/// Parses ADDRESS:PORT. Throws std::invalid_argument that quotes the text.
Endpoint parseEndpoint(const std::string& text);

/// Settings of the two simulated cameras.
struct CameraPairSettings {
  Endpoint left{.port = 8554};
  Endpoint right{.port = 8555};
  std::string user = "admin";
  std::string password;
  /// The lead-in shows the first picture for this long, so that receivers get a key frame and a sender report
  /// first.
  std::chrono::nanoseconds lead_in = std::chrono::seconds(3);
  std::chrono::nanoseconds latency{0};  ///< from the exposure of a picture to its sending
  ContentStart start = ContentStart::at_once;
  ContentEnd end = ContentEnd::stop;
};

/// Throws std::runtime_error unless both cameras can listen, at the same time, on their addresses.
void requireFreeAddresses(const CameraPairSettings& settings);

/// Two simulated cameras on one clock: content instant 0 is the same system time for both.
class CameraPairSimulation {
 public:
  /// Starts both cameras, which send at once. Throws what SimulatedCamera throws.
  CameraPairSimulation(const std::shared_ptr<const EncodedPair>& streams, const CameraPairSettings& settings);

  /// Starts the content when its start condition holds; to be called about ten times a second.
  void update();

  /// System time of content instant 0, ns since the Unix epoch; none before the content is started.
  std::optional<std::int64_t> epoch() const { return epoch_ns_; }

  /// Whether both cameras have sent all of their content.
  bool isFinished() const { return left_.isFinished() && right_.isFinished(); }

  const SimulatedCamera& left() const { return left_; }
  const SimulatedCamera& right() const { return right_; }

 private:
  CameraPairSettings settings_;
  double frame_rate_;
  std::int64_t switched_on_ns_;
  std::optional<std::int64_t> epoch_ns_;
  SimulatedCamera left_;
  SimulatedCamera right_;
};

}  // namespace cartvo::simulate
