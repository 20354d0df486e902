// Runs two simulated cameras that show one drive on a common clock.
#include "tools/simulate/server/camera_pair_simulation.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "common/host_clock.hpp"
#include "tools/simulate/server/frame_schedule.hpp"
#include "tools/simulate/server/rtsp_server.hpp"

namespace cartvo::simulate {
namespace {

// Period of the repeated content, ns: the same for both cameras, so that their time offset is the same in
// each repetition.
std::int64_t contentPeriodNs(const EncodedPair& streams) {
  const auto span = [](const EncodedStream& stream) {
    return stream.units.back().instant_ns - stream.units.front().instant_ns +
           std::llround(1e9 / stream.frame_rate);
  };
  return std::max(span(streams.left), span(streams.right));
}

SimulatedCameraSettings cameraSettings(const CameraPairSettings& settings, const Endpoint& endpoint,
                                       const EncodedPair& streams, std::int64_t switched_on_ns) {
  return {.address = endpoint.address,
          .port = endpoint.port,
          .user = settings.user,
          .password = settings.password,
          .switched_on_ns = switched_on_ns,
          .latency = settings.latency,
          .repeat_after_ns = settings.end == ContentEnd::repeat ? contentPeriodNs(streams) : 0};
}

}  // namespace

Endpoint parseEndpoint(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  Endpoint endpoint;
  if (colon != std::string::npos && colon > 0) {
    endpoint.address = text.substr(0, colon);
    const char* begin = text.data() + colon + 1;
    const char* end = text.data() + text.size();
    const auto [parsed, error] = std::from_chars(begin, end, endpoint.port);
    if (error == std::errc() && parsed == end) return endpoint;
  }
  throw std::invalid_argument("'" + text + "' is not ADDRESS:PORT, such as 127.0.0.1:8554");
}

void requireFreeAddresses(const CameraPairSettings& settings) {
  const auto left = RtspServer::reserve(settings.left.address, settings.left.port);
  const auto right = RtspServer::reserve(settings.right.address, settings.right.port);
}

CameraPairSimulation::CameraPairSimulation(const std::shared_ptr<const EncodedPair>& streams,
                                           const CameraPairSettings& settings)
    : settings_(settings),
      frame_rate_(streams->left.frame_rate),
      // Whole milliseconds lie on the 90 kHz grid of RTP time stamps.
      switched_on_ns_(hostNow() / 1'000'000 * 1'000'000),
      left_({streams, &streams->left}, cameraSettings(settings, settings.left, *streams, switched_on_ns_)),
      right_({streams, &streams->right},
             cameraSettings(settings, settings.right, *streams, switched_on_ns_)) {}

void CameraPairSimulation::update() {
  if (epoch_ns_) return;
  const bool watched = left_.playingClients() > 0 && right_.playingClients() > 0;
  if (settings_.start == ContentStart::when_watched && !watched) return;
  epoch_ns_ = nextFrameInstant(switched_on_ns_, frame_rate_, hostNow() + settings_.lead_in.count());
  left_.startContent(*epoch_ns_);
  right_.startContent(*epoch_ns_);
}

}  // namespace cartvo::simulate
