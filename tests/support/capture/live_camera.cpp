// Simulated cameras and helpers for tests of live connections.

#include "tests/support/capture/live_camera.hpp"

#include <string>
#include <utility>

#include "support/pattern_content.hpp"
#include "support/test_timeout.hpp"
#include "tools/simulate/stream/encode_content.hpp"

namespace cartvo::test {

using simulate::EncodedStream;
using simulate::SimulatedCamera;
using simulate::SimulatedCameraSettings;
using std::chrono::milliseconds;

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

namespace {

const std::shared_ptr<const simulate::EncodedPair>& encoded() {
  static const auto kPair = [] {
    PatternSettings pattern;
    pattern.size = {240, 180};
    pattern.frame_rate = 25.0;
    pattern.pairs = 50;
    pattern.offset_s = static_cast<double>(kLiveOffset_ns) * 1e-9;
    simulate::EncoderSettings encoder;
    encoder.key_frame_interval = 0.4;
    return std::make_shared<const simulate::EncodedPair>(
        encodeContent(PatternContent(pattern), encoder, [](int, int) {}));
  }();
  return kPair;
}

}  // namespace

std::shared_ptr<const EncodedStream> leftStream() {
  return {encoded(), &encoded()->left};
}
std::shared_ptr<const EncodedStream> rightStream() {
  return {encoded(), &encoded()->right};
}

std::unique_ptr<SimulatedCamera> startCamera(std::shared_ptr<const EncodedStream> stream,
                                             std::uint16_t port) {
  SimulatedCameraSettings settings;
  settings.port = port;
  settings.password = kLivePassword;
  settings.repeat_after_ns = kLiveDuration_ns;
  return std::make_unique<SimulatedCamera>(std::move(stream), settings);
}

capture::RtspCameraSettings settingsFor(std::uint16_t port) {
  capture::RtspCameraSettings settings;
  settings.url = "rtsp://127.0.0.1:" + std::to_string(port) + "/Streaming/Channels/101";
  settings.credentials = {"admin", kLivePassword};
  settings.connect_timeout = milliseconds(10000);
  settings.first_retry = milliseconds(50);
  settings.longest_retry = milliseconds(200);
  return settings;
}

bool readUntil(capture::RtspCamera& camera,
               const std::function<bool(capture::ReadOutcome, const capture::Frame&)>& done) {
  const std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::now() + kTestTimeout;
  capture::Frame frame;
  while (std::chrono::steady_clock::now() < deadline) {
    const capture::ReadOutcome outcome = camera.read(frame, milliseconds(100));
    if (done(outcome, frame)) return true;
  }
  return false;
}

bool readFrames(capture::RtspCamera& camera, int count) {
  return readUntil(camera, [&](capture::ReadOutcome outcome, const capture::Frame&) {
    return outcome == capture::ReadOutcome::frame && --count == 0;
  });
}

}  // namespace cartvo::test
