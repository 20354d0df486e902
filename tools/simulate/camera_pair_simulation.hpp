#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "tools/simulate/encoded_stream.hpp"
#include "tools/simulate/simulated_camera.hpp"

namespace cartvo::simulate {

/// When the content begins.
enum class ContentStart : std::uint8_t {
  at_once,       ///< a lead-in after the cameras are switched on
  when_watched,  ///< a lead-in after both cameras are being played
};

/// What comes after the content.
enum class ContentEnd : std::uint8_t { stop, repeat };

struct Endpoint {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: one that is free
};

/// ADDRESS:PORT. Throws std::invalid_argument naming the text.
Endpoint parseEndpoint(const std::string& text);

struct CameraPairSettings {
  Endpoint left{.port = 8554};
  Endpoint right{.port = 8555};
  std::string user = "admin";
  std::string password;
  /// The first pictures stand still this long, so that receivers have their first key frame and sender
  /// report.
  std::chrono::nanoseconds lead_in = std::chrono::seconds(3);
  std::chrono::nanoseconds latency{0};  ///< from a picture's exposure to its sending
  ContentStart start = ContentStart::at_once;
  ContentEnd end = ContentEnd::stop;
};

/// The two simulated cameras on one clock: content instant 0 is the same moment for both.
class CameraPairSimulation {
 public:
  /// Both cameras send from now on. Throws what SimulatedCamera throws.
  CameraPairSimulation(const std::shared_ptr<const EncodedPair>& streams, const CameraPairSettings& settings);

  /// To be called some ten times a second: starts the content when its time has come.
  void update();

  /// The instant of content time 0 (ns since the Unix epoch), once it is known.
  std::optional<std::int64_t> epoch() const { return epoch_ns_; }

  /// Whether both cameras have sent all their content.
  bool finished() const { return left_.finished() && right_.finished(); }

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
