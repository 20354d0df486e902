// Faults of cameras and networks, over real sockets on loopback, from a scripted camera.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/codec/video_decoder.hpp"
#include "capture/rtsp/rtsp_camera.hpp"
#include "common/statistics.hpp"
#include "support/resources.hpp"
#include "tests/support/capture/encoded_sequence.hpp"
#include "tests/support/capture/live_camera.hpp"
#include "tests/support/capture/scripted_camera.hpp"

namespace cartvo::capture {
namespace {

using std::chrono::milliseconds;
using test::CameraScript;
using test::ScriptedCamera;
using testing::HasSubstr;

const cv::Size kSize(240, 180);

CameraScript script(VideoCodec codec) {
  CameraScript script;
  script.codec = codec;
  script.pictures = test::encodeSequence(codec, kSize, 40, 10, "");
  return script;
}

RtspCameraSettings settingsFor(const ScriptedCamera& camera, RtspTransport transport) {
  RtspCameraSettings settings = test::settingsFor(camera.port());
  settings.credentials = {};
  settings.transport = transport;
  settings.first_retry = settings.longest_retry = milliseconds(20);
  return settings;
}

/// Counts of the frames read.
struct FrameCounts {
  int good = 0;
  int damaged = 0;
  int wrong = 0;  ///< marked good, but different from the encoded pictures
};

FrameCounts read(RtspCamera& camera, int frames, const std::set<std::uint64_t>& hashes) {
  FrameCounts seen;
  test::readUntil(camera, [&](ReadOutcome outcome, const Frame& frame) {
    if (outcome != ReadOutcome::frame) return false;
    if (frame.status == FrameStatus::damaged) {
      ++seen.damaged;
    } else {
      ++seen.good;
      seen.wrong += hashes.count(test::digest(frame.image)) == 0 ? 1 : 0;
    }
    return seen.good + seen.damaged >= frames;
  });
  return seen;
}

class RtspPacketLoss : public testing::TestWithParam<double> {};

TEST_P(RtspPacketLoss, MarksAllDamagedFrames) {
  CameraScript lossy = script(VideoCodec::h264);
  lossy.frame_rate = 100.0;
  auto random = std::make_shared<std::mt19937>(7);
  lossy.link = [random, share = GetParam()](const auto& packet, const auto& send) {
    if (static_cast<double>((*random)()) / 4294967296.0 >= share) send(packet);
  };
  ScriptedCamera server(lossy);
  RtspCamera camera(settingsFor(server, RtspTransport::udp));
  const FrameCounts seen = read(camera, 400, test::digestsOf(lossy.codec, lossy.pictures));
  EXPECT_EQ(seen.wrong, 0);
  EXPECT_GT(seen.good, 5);
  if (GetParam() >= 0.01) {
    EXPECT_GT(seen.damaged, 0);
  }
  EXPECT_EQ(camera.health().damaged, static_cast<std::uint64_t>(seen.damaged));
  EXPECT_EQ(camera.health().reconnections, 0U);
}

INSTANTIATE_TEST_SUITE_P(RtspFault, RtspPacketLoss, testing::Values(0.001, 0.01, 0.05));

FrameCounts seenOverUdp(const CameraScript& script) {
  ScriptedCamera server(script);
  RtspCamera camera(settingsFor(server, RtspTransport::udp));
  return read(camera, 60, test::digestsOf(script.codec, script.pictures));
}

TEST(RtspFault, RestoresOrderOfPackets) {
  CameraScript reordering = script(VideoCodec::h264);
  auto held = std::make_shared<CameraScript::Packet>();
  auto count = std::make_shared<int>(0);
  reordering.link = [held, count](const auto& packet, const auto& send) {
    if (++*count % 10 == 0) {
      *held = packet;
      return;
    }
    send(packet);
    if (!held->empty()) send(*held);
    held->clear();
  };
  const FrameCounts seen = seenOverUdp(reordering);
  EXPECT_EQ(seen.damaged, 0);
  EXPECT_EQ(seen.wrong, 0);
}

TEST(RtspFault, ToleratesDuplicatePackets) {
  CameraScript repeating = script(VideoCodec::h264);
  auto random = std::make_shared<std::mt19937>(7);
  repeating.link = [random](const auto& packet, const auto& send) {
    send(packet);
    if ((*random)() % 8 == 0) send(packet);
  };
  const FrameCounts seen = seenOverUdp(repeating);
  EXPECT_EQ(seen.wrong, 0);
  EXPECT_EQ(seen.damaged, 0);
}

TEST(RtspFault, KeepsInstantsSteadyUnderJitterOfFiftyMilliseconds) {
  CameraScript with_jitter = script(VideoCodec::h264);
  auto random = std::make_shared<std::mt19937>(7);
  with_jitter.link = [random](const auto& packet, const auto& send) {
    const bool last_of_picture = (packet[1] & 0x80) != 0;
    if (last_of_picture && (*random)() % 4 == 0) std::this_thread::sleep_for(milliseconds((*random)() % 50));
    send(packet);
  };
  ScriptedCamera server(with_jitter);
  RtspCamera camera(settingsFor(server, RtspTransport::udp));
  std::optional<std::int64_t> last;
  std::int64_t shortest = 1'000'000'000;
  std::int64_t longest = 0;
  int frames = 0;
  EXPECT_TRUE(test::readUntil(camera, [&](ReadOutcome outcome, const Frame& frame) {
    if (outcome != ReadOutcome::frame) return false;
    EXPECT_EQ(frame.status, FrameStatus::good) << frame.sequence;
    if (last) {
      shortest = std::min(shortest, frame.exposure_ns - *last);
      longest = std::max(longest, frame.exposure_ns - *last);
    }
    last = frame.exposure_ns;
    return ++frames == 75;
  }));
  EXPECT_GE(shortest, 29'000'000);  // 40 ms, slewed by up to a quarter while the clock model settles
  EXPECT_LE(longest, 51'000'000);
}

TEST(RtspFault, SurvivesInvalidPackets) {
  for (const RtspTransport transport : {RtspTransport::tcp, RtspTransport::udp}) {
    CameraScript garbled = script(VideoCodec::h264);
    auto random = std::make_shared<std::mt19937>(7);
    garbled.link = [random](const auto& packet, const auto& send) {
      CameraScript::Packet bad = packet;
      if ((*random)() % 8 == 0) bad.resize((*random)() % bad.size());
      if ((*random)() % 8 == 0) {
        for (int i = 0; i < 4 && bad.size() > 12; ++i)
          bad[12 + (*random)() % (bad.size() - 12)] = static_cast<std::uint8_t>((*random)());
      }
      if ((*random)() % 8 == 0)
        send(CameraScript::Packet((*random)() % 40, static_cast<std::uint8_t>((*random)())));
      send(bad);
    };
    ScriptedCamera server(garbled);
    RtspCamera camera(settingsFor(server, transport));
    const FrameCounts seen = read(camera, 40, {});
    EXPECT_GE(seen.good + seen.damaged, 40);
  }
}

TEST(RtspFault, ReportsOrIgnoresInvalidSessionDescription) {
  const std::string bad[] = {
      "garbage",
      std::string(3000, '\xff'),
      "v=0\r\nm=video 0 RTP/AVP 96\r\na=rtpmap:96 H264/0\r\na=fmtp:96 sprop-parameter-sets=%%%%,;;==\r\n",
      "v=0\r\nm=audio 0 RTP/AVP 0\r\n",
      "v=0\r\nm=video 99999999999 RTP/AVP 300\r\na=rtpmap:300\r\na=control:\r\n",
  };
  int errors = 0;
  for (const std::string& description : bad) {
    CameraScript with_description = script(VideoCodec::h264);
    with_description.description = description;
    ScriptedCamera server(with_description);
    RtspCameraSettings settings = settingsFor(server, RtspTransport::tcp);
    settings.connect_timeout = milliseconds(2000);
    RtspCamera camera(settings);
    EXPECT_TRUE(test::readUntil(camera, [&](ReadOutcome outcome, const Frame&) {
      return outcome == ReadOutcome::frame || !camera.health().last_error.empty();
    })) << description;
    if (camera.health().last_error.empty()) continue;
    EXPECT_THAT(camera.health().last_error, HasSubstr("127.0.0.1"));
    ++errors;
  }
  EXPECT_GE(errors, 3);
}

TEST(RtspFault, DecodesOtherResolutionFromItsFirstKeyFrame) {
  const CameraScript before = script(VideoCodec::h264);
  CameraScript after = before;
  after.pictures = test::encodeSequence(VideoCodec::h264, {320, 200}, 40, 10, "ref=3:slices=2:cabac=0");
  ScriptedCamera server(before);
  RtspCamera camera(settingsFor(server, RtspTransport::tcp));
  ASSERT_TRUE(test::readFrames(camera, 30));
  server.setPictures(after.pictures);
  const std::set<std::uint64_t> hashes = test::digestsOf(after.codec, after.pictures);
  int changed = 0;
  EXPECT_TRUE(test::readUntil(camera, [&](ReadOutcome outcome, const Frame& frame) {
    if (outcome != ReadOutcome::frame || frame.image.size() == kSize) return false;
    EXPECT_EQ(frame.image.size(), cv::Size(320, 200));
    if (frame.status == FrameStatus::good) {
      EXPECT_EQ(hashes.count(test::digest(frame.image)), 1U);
      ++changed;
    }
    return changed == 30;
  }));
  EXPECT_EQ(camera.health().reconnections, 0U);
}

TEST(RtspFault, DetectsFrozenPicture) {
  CameraScript frozen = script(VideoCodec::h264);
  const std::vector<EncodedUnit> moving = frozen.pictures;
  ScriptedCamera server(frozen);
  RtspCameraSettings settings = settingsFor(server, RtspTransport::tcp);
  settings.frozen_after = milliseconds(500);
  RtspCamera camera(settings);
  ASSERT_TRUE(test::readFrames(camera, 30));
  EXPECT_EQ(camera.health().state, CameraState::streaming);
  server.setPictures({moving.front()});
  EXPECT_TRUE(test::readUntil(
      camera, [&](ReadOutcome, const Frame&) { return camera.health().state == CameraState::frozen; }));
  EXPECT_THAT(camera.health().last_error,
              HasSubstr("is frozen: it has sent the same picture for more than 0.5 s"));
  server.setPictures(moving);
  EXPECT_TRUE(test::readUntil(
      camera, [&](ReadOutcome, const Frame&) { return camera.health().state == CameraState::streaming; }));
}

/// Reads a camera whose wall clock has the error `clock_error` (as CameraScript's) and expects increasing
/// exposures near the arrivals, until `done` returns true for the clock's status and the number of frames.
void expectSteadyExposures(const std::function<double(double)>& clock_error,
                           const std::function<bool(const ClockStatus::Camera&, int)>& done) {
  CameraScript with_clock_error = script(VideoCodec::h264);
  with_clock_error.clock_error = clock_error;
  ScriptedCamera server(with_clock_error);
  StereoTimestamper clock(ClockChoice::automatic);
  RtspCamera camera(settingsFor(server, RtspTransport::tcp));
  camera.setTimestamper(clock, CameraSide::left);
  std::int64_t last = 0;
  int frames = 0;
  EXPECT_TRUE(test::readUntil(camera, [&](ReadOutcome outcome, const Frame& frame) {
    if (outcome != ReadOutcome::frame) return false;
    EXPECT_GT(frame.exposure_ns, last);
    EXPECT_LT(std::abs(frame.exposure_ns - frame.arrival_ns), 2'000'000'000);
    last = frame.exposure_ns;
    return done(clock.status().cameras[0], ++frames);
  }));
}

TEST(RtspFault, KeepsExposuresSteadyWhenCameraClockIsSetByAnHour) {
  expectSteadyExposures([](double time) { return time < 2.0 ? 0.0 : 3600.0; },
                        [](const ClockStatus::Camera& camera, int) { return camera.steps > 0; });
}

TEST(RtspFault, KeepsExposuresSteadyAfterReportWrongByAnHour) {
  expectSteadyExposures([](double time) { return time < 1.0 || time > 1.3 ? 0.0 : 3600.0; },
                        [](const ClockStatus::Camera&, int frames) { return frames == 75; });
}

/// Number of reconnections; CARTVO_RECONNECTIONS sets a larger one for long runs.
int reconnectionsWanted() {
  const char* wanted = std::getenv("CARTVO_RECONNECTIONS");
  return wanted == nullptr ? 150 : std::atoi(wanted);
}

TEST(RtspFault, ReconnectsWithoutLeakWhileOtherCameraContinues) {
  CameraScript flapping = script(VideoCodec::h264);
  flapping.frame_rate = 200.0;
  flapping.pictures_per_client = 4;
  ScriptedCamera server(flapping);
  RtspCameraSettings settings = settingsFor(server, RtspTransport::tcp);
  settings.first_retry = settings.longest_retry = milliseconds(1);
  RtspCamera camera(settings);

  ScriptedCamera steady_server(script(VideoCodec::h264));
  RtspCamera steady(settingsFor(steady_server, RtspTransport::tcp));
  std::atomic<bool> done = false;
  std::thread other([&] {
    Frame frame;
    std::optional<std::uint64_t> last;
    while (!done) {
      if (steady.read(frame, milliseconds(200)) != ReadOutcome::frame) continue;
      EXPECT_EQ(frame.status, FrameStatus::good);
      EXPECT_EQ(frame.sequence, last.value_or(frame.sequence - 1) + 1);
      last = frame.sequence;
    }
  });

  const auto read_until = [&](int connections) {
    Frame frame;
    std::int64_t last = 0;
    const auto timeout = std::chrono::seconds(60) + connections * milliseconds(500);
    const auto end = std::chrono::steady_clock::now() + timeout;
    while (server.connections() < connections && std::chrono::steady_clock::now() < end) {
      if (camera.read(frame, milliseconds(200)) != ReadOutcome::frame) continue;
      EXPECT_GT(frame.exposure_ns, last);
      last = frame.exposure_ns;
    }
    EXPECT_GE(server.connections(), connections);
  };
  read_until(30);
  const test::Resources before = test::resourcesInUse();
  read_until(30 + reconnectionsWanted());
  const test::Resources after = test::resourcesInUse();
  done = true;
  other.join();
  EXPECT_NEAR(static_cast<double>(after.descriptors), static_cast<double>(before.descriptors), 6.0);
  EXPECT_NEAR(static_cast<double>(after.threads), static_cast<double>(before.threads), 2.0);
#if !defined(__SANITIZE_ADDRESS__)  // ASan delays freeing, and detects leaks itself
  EXPECT_LT(after.megabytes - before.megabytes, 8.0);
#endif
  EXPECT_EQ(steady.health().reconnections, 0U);
  std::printf("%d connections: %+td descriptors, %+td threads, %+.1f MB\n", server.connections(),
              after.descriptors - before.descriptors, after.threads - before.threads,
              after.megabytes - before.megabytes);
}

using CodecAndTransport = std::tuple<VideoCodec, RtspTransport>;
class RtspLatency : public testing::TestWithParam<CodecAndTransport> {};

TEST_P(RtspLatency, DecodesPictureWithItsLastPacket) {
  CameraScript slow = script(std::get<0>(GetParam()));
  slow.frame_rate = 10.0;
  ScriptedCamera server(slow);
  RtspCamera camera(settingsFor(server, std::get<1>(GetParam())));
  std::vector<double> delays;  // last packet to decoded picture, ms
  int frames = 0;
  EXPECT_TRUE(test::readUntil(camera, [&](ReadOutcome outcome, const Frame& frame) {
    if (outcome != ReadOutcome::frame) return false;
    EXPECT_EQ(frame.status, FrameStatus::good);
    if (++frames > 35) delays.push_back(static_cast<double>(frame.decoded_ns - frame.arrival_ns) * 1e-6);
    return delays.size() == 15;
  }));
  ASSERT_FALSE(delays.empty());
  const double delay = median(delays);
  std::printf("last packet to decoded picture: %.2f ms, median\n", delay);
  EXPECT_LT(delay, 50.0) << "half a frame period";
}

std::string parameterName(const testing::TestParamInfo<CodecAndTransport>& parameters) {
  return std::string(std::get<0>(parameters.param) == VideoCodec::h264 ? "H264" : "H265") +
         (std::get<1>(parameters.param) == RtspTransport::tcp ? "Tcp" : "Udp");
}

INSTANTIATE_TEST_SUITE_P(RtspFault, RtspLatency,
                         testing::Combine(testing::Values(VideoCodec::h264, VideoCodec::h265),
                                          testing::Values(RtspTransport::tcp, RtspTransport::udp)),
                         parameterName);

}  // namespace
}  // namespace cartvo::capture
