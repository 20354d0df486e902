// Frames of a live connection, over real sockets on loopback, from the simulated camera. Validation of an
// RTSP camera's settings. Health of a camera names each kind of data that is left out, over real sockets on
// loopback.
#include "capture/rtsp/rtsp_camera.hpp"

#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/codec/video_decoder.hpp"
#include "capture/pair_synchroniser.hpp"
#include "capture/recording/recording_source.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "support/temporary_folder.hpp"
#include "tests/support/capture/encoded_sequence.hpp"
#include "tests/support/capture/frame_digest.hpp"
#include "tests/support/capture/live_camera.hpp"
#include "tests/support/capture/scripted_camera.hpp"

namespace cartvo::capture {
namespace {

using simulate::EncodedStream;
using simulate::SimulatedCamera;
using simulate::SimulatedCameraSettings;
using std::chrono::milliseconds;
using test::CameraScript;
using test::ScriptedCamera;

/// Limit of the exposures' error, standard deviations. On a busy host arrivals are late and the stated
/// deviation is larger; the accuracy of the clock model is tested separately.
constexpr double kGate = 3.0;

/// Index of each picture in the content, by the hash of its pixels.
std::map<std::uint64_t, std::size_t> contentByHash(const EncodedStream& stream) {
  VideoDecoder decoder({VideoCodec::h264, {}}, 1);
  std::map<std::uint64_t, std::size_t> content;
  for (std::size_t i = 0; i < stream.units.size(); ++i) {
    EncodedUnit unit;
    const auto data = stream.data(stream.units[i]);
    unit.data.assign(data.begin(), data.end());
    unit.sequence = i;
    unit.key = stream.units[i].key_frame;
    decoder.send(unit);
    if (const std::optional<Frame> frame = decoder.receive()) content[test::digest(frame->image)] = i;
  }
  return content;
}

class RtspCameraTransport : public testing::TestWithParam<RtspTransport> {};

TEST_P(RtspCameraTransport, DeliversPicturesCompleteInOrderAndWithTheirExposures) {
  const EncodedStream& stream = *test::leftStream();
  const std::map<std::uint64_t, std::size_t> content = contentByHash(stream);
  const auto server = test::startCamera(test::leftStream());
  RtspCameraSettings settings = test::settingsFor(server->port());
  settings.transport = GetParam();
  RtspCamera camera(settings);
  ASSERT_TRUE(test::readFrames(camera, 1));
  const std::int64_t epoch = test::nowNs() / 1000 * 1000 + 100'000'000;
  server->startContent(epoch);

  int checked = 0;
  std::optional<std::uint64_t> last_sequence;
  const bool enough = test::readUntil(camera, [&](ReadOutcome outcome, const Frame& frame) {
    if (outcome != ReadOutcome::frame) return false;
    EXPECT_EQ(frame.status, FrameStatus::good);
    if (last_sequence) {
      EXPECT_EQ(frame.sequence, *last_sequence + 1);
    }
    last_sequence = frame.sequence;
    const auto found = content.find(test::digest(frame.image));
    if (found == content.end() || found->second == 0) return false;  // the lead-in is static
    if (frame.instant_source != InstantSource::sender_report) return false;
    const std::int64_t expected = epoch + stream.units[found->second].instant_ns;
    EXPECT_NEAR(static_cast<double>((frame.exposure_ns - expected) % test::kLiveDuration_ns), 0.0,
                kGate * static_cast<double>(frame.exposure_stddev_ns));
    EXPECT_GE(frame.decoded_ns, frame.arrival_ns);
    return ++checked == 40;
  });
  EXPECT_TRUE(enough) << checked;
  EXPECT_EQ(camera.health().damaged, 0U);
  EXPECT_EQ(camera.health().reconnections, 0U);
  EXPECT_EQ(camera.health().state, CameraState::streaming);
}

std::string transportName(const testing::TestParamInfo<RtspTransport>& transport) {
  return transport.param == RtspTransport::tcp ? "Tcp" : "Udp";
}

INSTANTIATE_TEST_SUITE_P(RtspCamera, RtspCameraTransport,
                         testing::Values(RtspTransport::tcp, RtspTransport::udp), transportName);

TEST(RtspCamera, DeliversPictureWithItsLastPacket) {
  const EncodedStream& stream = *test::leftStream();
  const std::map<std::uint64_t, std::size_t> content = contentByHash(stream);
  SimulatedCameraSettings once;
  once.password = test::kLivePassword;
  SimulatedCamera server(test::leftStream(), once);
  RtspCamera camera(test::settingsFor(server.port()));
  ASSERT_TRUE(test::readFrames(camera, 1));
  server.startContent(test::nowNs());
  // No picture follows the last one, so it can only be completed by its own packets.
  EXPECT_TRUE(test::readUntil(camera, [&](ReadOutcome outcome, const Frame& frame) {
    if (outcome != ReadOutcome::frame) return false;
    const auto found = content.find(test::digest(frame.image));
    return found != content.end() && found->second + 1 == stream.units.size();
  }));
}

TEST(RtspCamera, RecordingOfLiveStreamReplaysSameFrames) {
  const test::TemporaryFolder folder;
  const auto server = test::startCamera(test::leftStream());
  std::vector<test::FrameDigest> live;
  {
    RecordingSettings settings;
    settings.folder = folder / "drive";
    StreamRecorder recorder(settings);
    RtspCamera camera(test::settingsFor(server->port()));
    camera.setObserver(recorder.left());
    server->startContent(test::nowNs());
    ASSERT_TRUE(test::readUntil(camera, [&](ReadOutcome outcome, const Frame& frame) {
      if (outcome == ReadOutcome::frame) live.push_back(test::digestOf(frame));
      return live.size() == 50;
    }));
    EXPECT_EQ(recorder.health().error, "");
  }
  std::vector<test::FrameDigest> replayed;
  RecordingSource source(folder / "drive", CameraSide::left);
  Frame frame;
  while (source.read(frame, milliseconds(0)) == ReadOutcome::frame)
    replayed.push_back(test::digestOf(frame));
  ASSERT_GE(replayed.size(), live.size());  // the last picture may have been received but not read
  replayed.resize(live.size());
  EXPECT_EQ(replayed, live);
}

TEST(RtspCamera, TwoCamerasPairWithTheirTrueOffset) {
  const auto left = test::startCamera(test::leftStream());
  const auto right = test::startCamera(test::rightStream());
  const std::int64_t epoch = test::nowNs() / 1000 * 1000 + 1'000'000'000;
  left->startContent(epoch);
  right->startContent(epoch);

  PairSynchroniser synchroniser({});
  std::mutex mutex;
  std::vector<FramePair> pairs;
  const auto feed = [&](CameraSide side, std::uint16_t port) {
    RtspCamera camera(test::settingsFor(port));
    test::readUntil(camera, [&](ReadOutcome outcome, Frame frame) {
      const std::lock_guard lock(mutex);
      if (outcome == ReadOutcome::frame) synchroniser.push(side, std::move(frame));
      while (std::optional<FramePair> pair = synchroniser.pop()) {
        if (pair->left.exposure_ns > epoch) pairs.push_back(std::move(*pair));
      }
      return pairs.size() > 40;
    });
  };
  std::thread other([&] { feed(CameraSide::right, right->port()); });
  feed(CameraSide::left, left->port());
  other.join();
  int exact = 0;
  for (const FramePair& pair : pairs) {
    EXPECT_LE(std::abs(pair.offsetNs()), 20'000'000);
    if (pair.left.instant_source != InstantSource::sender_report) continue;
    const double stddev = std::hypot(static_cast<double>(pair.left.exposure_stddev_ns),
                                     static_cast<double>(pair.right.exposure_stddev_ns));
    EXPECT_NEAR(static_cast<double>(pair.offsetNs()), static_cast<double>(test::kLiveOffset_ns),
                kGate * stddev);
    ++exact;
  }
  EXPECT_GT(exact, 10);
}

std::string errorOf(const RtspCameraSettings& settings) {
  try {
    const RtspCamera camera(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::string errorOfUrl(const std::string& url) {
  RtspCameraSettings settings;
  settings.url = url;
  return errorOf(settings);
}

TEST(RtspCameraSettings, AcceptsOrdinaryUrl) {
  EXPECT_EQ(errorOfUrl("rtsp://10.0.0.1:554/Streaming/Channels/101"), "");
}

TEST(RtspCameraSettings, RejectsCredentialsInUrlWithoutRepeatingThem) {
  const std::string message = errorOfUrl("rtsp://admin:hunter2@10.0.0.1/101");
  EXPECT_THAT(message, testing::HasSubstr("must not contain a user or password"));
  EXPECT_THAT(message, testing::HasSubstr("give them as the camera's credentials"));
  EXPECT_THAT(message, testing::Not(testing::HasSubstr("hunter2")));
}

TEST(RtspCameraSettings, RejectsInvalidUrl) {
  EXPECT_THAT(errorOfUrl("http://10.0.0.1/"), testing::HasSubstr("must begin with rtsp://"));
  EXPECT_THAT(errorOfUrl("rtsp://10.0.0.1/a b"), testing::HasSubstr("white space"));
  EXPECT_THAT(errorOfUrl("rtsp:///101"), testing::HasSubstr("must contain a host"));
}

TEST(RtspCameraSettings, RejectsTimeoutOfZero) {
  RtspCameraSettings settings;
  settings.url = "rtsp://10.0.0.1/101";
  settings.stall_timeout = std::chrono::milliseconds(0);
  EXPECT_THAT(errorOf(settings), testing::HasSubstr("time-outs must be positive"));
}

CameraScript faultlessScript() {
  CameraScript script;
  script.pictures = test::encodeSequence(VideoCodec::h264, {240, 180}, 40, 10, "");
  return script;
}

/// Reads until the camera's advice contains the text.
void expectAdvice(const CameraScript& with_fault, const std::string& text) {
  ScriptedCamera server(with_fault);
  RtspCameraSettings settings = test::settingsFor(server.port());
  settings.credentials = {};
  RtspCamera camera(settings);
  EXPECT_TRUE(test::readUntil(camera, [&](ReadOutcome, const Frame&) {
    return camera.health().advice.find(text) != std::string::npos;
  })) << camera.health().advice;
  EXPECT_EQ(camera.health().reconnections, 0U);
}

TEST(RtspLeftOut, NamesReportsOfAClockThatIsNotSet) {
  CameraScript unset = faultlessScript();
  unset.clock_error = [](double) { return -2.0e9; };
  expectAdvice(unset, "sender reports that state a time before 1970: set its clock");
}

TEST(RtspLeftOut, NamesPicturesWhoseRtpTimeIsAnother) {
  CameraScript stray = faultlessScript();
  stray.frame_rate = 100.0;
  auto pictures = std::make_shared<int>(0);
  stray.link = [pictures](const CameraScript::Packet& packet, const CameraScript::Send& send) {
    CameraScript::Packet changed = packet;
    if (*pictures % 3 == 2) changed[4] ^= 0x40;  // of the RTP time
    if ((packet[1] & 0x80) != 0) ++*pictures;
    send(changed);
  };
  expectAdvice(stray, "pictures whose RTP time does not follow from that of the others (100 or more)");
}

}  // namespace
}  // namespace cartvo::capture
