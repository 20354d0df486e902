// Frames of a live connection, over real sockets on loopback, from the simulated camera.

#include "capture/rtsp/rtsp_camera.hpp"

#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "capture/codec/video_decoder.hpp"
#include "capture/pair_synchroniser.hpp"
#include "capture/recording/recording_source.hpp"
#include "capture/recording/stream_recorder.hpp"
#include "support/temporary_folder.hpp"
#include "tests/support/capture/frame_digest.hpp"
#include "tests/support/capture/live_camera.hpp"

namespace cartvo::capture {
namespace {

using simulate::EncodedStream;
using simulate::SimulatedCamera;
using simulate::SimulatedCameraSettings;
using std::chrono::milliseconds;

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

}  // namespace
}  // namespace cartvo::capture
