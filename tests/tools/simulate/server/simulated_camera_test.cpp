// Tests of the simulated camera with a libavformat client: timing, authentication, clients, shutdown.
#include "tools/simulate/server/simulated_camera.hpp"

#include <chrono>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <vector>

extern "C" {
#include <libavutil/error.h>
}

#include <gtest/gtest.h>

#include "support/pattern_content.hpp"
#include "support/tools/stream_client.hpp"
#include "tools/simulate/stream/encode_content.hpp"

namespace cartvo::simulate {
namespace {

// Capital letters and a hyphen, to detect clients that mishandle credentials.
const std::string kPassword = "Right-1";

constexpr std::int64_t kMicrosecond = 1'000;
constexpr std::int64_t kMillisecond = 1'000'000;

std::int64_t nowNs() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

const std::shared_ptr<const EncodedPair>& encodedPattern() {
  static const auto kPair = std::make_shared<const EncodedPair>(
      encodeContent(test::PatternContent({.size = {160, 120}, .pairs = 40, .offset_s = 0.0125}),
                    {.key_frame_interval = 0.5}, {}));
  return kPair;
}

std::shared_ptr<const EncodedStream> leftStream() {
  return {encodedPattern(), &encodedPattern()->left};
}
std::shared_ptr<const EncodedStream> rightStream() {
  return {encodedPattern(), &encodedPattern()->right};
}

bool becomesTrue(const std::function<bool()>& condition) {
  const std::int64_t deadline = nowNs() + 5'000 * kMillisecond;
  while (!condition() && nowNs() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return condition();
}

// Distance of an instant to the nearest point of a 20 Hz grid through `reference_ns`, ns.
std::int64_t distanceToGrid(std::int64_t instant_ns, std::int64_t reference_ns) {
  constexpr std::int64_t kPeriod = 50 * kMillisecond;
  const std::int64_t phase = ((instant_ns - reference_ns) % kPeriod + kPeriod) % kPeriod;
  return std::min(phase, kPeriod - phase);
}

TEST(SimulatedCamera, SenderReportsCarryExposureInstants) {
  SimulatedCamera camera(leftStream(), {.password = kPassword});
  const std::int64_t epoch = nowNs() + 2'500 * kMillisecond;
  camera.startContent(epoch);

  const test::ReceivedStream received = test::receive(camera.port(), "admin:" + kPassword, 200);

  ASSERT_EQ(received.open_error, 0);
  EXPECT_TRUE(received.ended);
  EXPECT_TRUE(camera.isFinished());
  int with_instant = 0;
  int content = 0;
  for (const test::ReceivedPacket& packet : received.packets) {
    if (packet.instant_ns == 0) continue;
    ++with_instant;
    if (packet.instant_ns < epoch - 25 * kMillisecond) continue;
    // The RTP clock has steps of 11 us; the rounding in the sender report adds to that.
    EXPECT_LE(distanceToGrid(packet.instant_ns, epoch), 20 * kMicrosecond);
    EXPECT_NEAR(static_cast<double>(packet.instant_ns - epoch), 50e6 * content, 20e3);
    EXPECT_GE(packet.arrival_ns, packet.instant_ns - 20 * kMicrosecond);
    ++content;
  }
  EXPECT_EQ(content, 40);
  EXPECT_GT(with_instant, 50);
}

TEST(SimulatedCamera, RequiresThePassword) {
  const SimulatedCamera camera(leftStream(), {.password = kPassword});

  EXPECT_EQ(test::receive(camera.port(), "admin:wrong", 1).open_error, AVERROR_HTTP_UNAUTHORIZED);
  EXPECT_EQ(test::receive(camera.port(), "somebody:" + kPassword, 1).open_error, AVERROR_HTTP_UNAUTHORIZED);
}

TEST(SimulatedCamera, ServesReconnectingClientsFromAKeyFrame) {
  SimulatedCamera camera(leftStream(), {.password = kPassword});
  camera.startContent(nowNs());
  for (int visit = 0; visit < 2; ++visit) {
    const test::ReceivedStream received = test::receive(camera.port(), "admin:" + kPassword, 5);
    ASSERT_EQ(received.packets.size(), 5U);
    EXPECT_TRUE(received.packets.front().key_frame);
  }
}

TEST(SimulatedCamera, CountsPlayingClients) {
  SimulatedCamera camera(leftStream(), {.password = kPassword});
  EXPECT_EQ(camera.playingClients(), 0);

  std::thread client([&camera] { test::receive(camera.port(), "admin:" + kPassword, 20); });
  EXPECT_TRUE(becomesTrue([&camera] { return camera.playingClients() == 1; }));
  client.join();
  EXPECT_TRUE(becomesTrue([&camera] { return camera.playingClients() == 0; }));
}

TEST(SimulatedCamera, ReleasesItsStreamWhenDestroyedWithActiveClients) {
  const auto stream = std::make_shared<const EncodedStream>(*leftStream());
  for (const int packets : {1, 5, 1'000}) {
    auto camera = std::make_unique<SimulatedCamera>(stream, SimulatedCameraSettings{.password = kPassword});
    std::vector<std::thread> clients;
    for (int i = 0; i < 3; ++i)
      clients.emplace_back(
          [packets, port = camera->port()] { test::receive(port, "admin:" + kPassword, packets); });
    EXPECT_TRUE(becomesTrue([&camera] { return camera->playingClients() > 0; }));
    camera.reset();
    // A GStreamer thread may release its last picture slightly later.
    EXPECT_TRUE(becomesTrue([&stream] { return stream.use_count() == 1; }));
    for (std::thread& client : clients)
      client.join();
  }
}

TEST(SimulatedCamera, RejectsClientsAfterTheContentHasEnded) {
  SimulatedCamera camera(leftStream(), {.password = kPassword});
  camera.startContent(nowNs() - 3'000 * kMillisecond);
  ASSERT_TRUE(becomesTrue([&camera] { return camera.isFinished(); }));
  EXPECT_EQ(test::receive(camera.port(), "admin:" + kPassword, 1).open_error, AVERROR_HTTP_SERVER_ERROR);
}

TEST(SimulatedCamera, TwoCamerasKeepTheirTimeOffset) {
  const std::int64_t switched_on = nowNs();
  const SimulatedCameraSettings settings{.password = kPassword, .switched_on_ns = switched_on};
  SimulatedCamera left(leftStream(), settings);
  SimulatedCamera right(rightStream(), settings);

  const test::ReceivedStream from_left = test::receive(left.port(), "admin:" + kPassword, 30);
  const test::ReceivedStream from_right = test::receive(right.port(), "admin:" + kPassword, 30);
  ASSERT_FALSE(from_left.packets.empty());
  ASSERT_FALSE(from_right.packets.empty());
  EXPECT_LE(distanceToGrid(from_left.packets.back().instant_ns, switched_on), 20 * kMicrosecond);
  EXPECT_LE(distanceToGrid(from_right.packets.back().instant_ns, switched_on + 12'500 * kMicrosecond),
            20 * kMicrosecond);
}

TEST(SimulatedCamera, ErrorNamesPortInUse) {
  const SimulatedCamera camera(leftStream(), {.password = kPassword});
  try {
    const SimulatedCamera second(leftStream(), {.port = camera.port(), .password = kPassword});
    FAIL() << "two cameras listen on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what())
                  .find("a simulated camera cannot listen on 127.0.0.1:" + std::to_string(camera.port())),
              0U)
        << error.what();
  }
}

}  // namespace
}  // namespace cartvo::simulate
