// Live: over real sockets on loopback, against the simulated camera.
#include "capture/rtsp_camera.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "capture/ffmpeg_log.hpp"
#include "capture/pair_synchroniser.hpp"
#include "capture/recording_source.hpp"
#include "capture/stream_recorder.hpp"
#include "capture/video_decoder.hpp"
#include "support/pattern_content.hpp"
#include "support/temporary_folder.hpp"
#include "tests/capture/encoded_sequence.hpp"
#include "tests/capture/tcp_proxy.hpp"
#include "tools/simulate/encode_content.hpp"
#include "tools/simulate/simulated_camera.hpp"

namespace cartvo {
namespace {

using simulate::EncodedStream;
using simulate::SimulatedCamera;
using simulate::SimulatedCameraSettings;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;
using Clock = std::chrono::steady_clock;

constexpr char kPassword[] = "p@ss:w/rd%";
constexpr double kFrameRate = 25.0;
constexpr std::int64_t kOffset_ns = 10'000'000;
constexpr std::int64_t kTurn_ns = 2'000'000'000;  ///< length of the content

/// Sender reports relate whole ticks of RTP's 90 kHz clock to instants, so each is up to a tick (11 us) off.
constexpr double kTwoTicks_ns = 23'000.0;

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// Two seconds of a moving pattern, encoded once for all tests.
const std::shared_ptr<const simulate::EncodedPair>& encoded() {
  static const auto kPair = [] {
    test::PatternSettings pattern;
    pattern.size = {240, 180};
    pattern.frame_rate = kFrameRate;
    pattern.pairs = 50;
    pattern.offset_s = static_cast<double>(kOffset_ns) * 1e-9;
    simulate::EncoderSettings encoder;
    encoder.key_frame_interval = 0.4;
    return std::make_shared<const simulate::EncodedPair>(
        encodeContent(test::PatternContent(pattern), encoder, [](int, int) {}));
  }();
  return kPair;
}

std::shared_ptr<const EncodedStream> leftStream() {
  return {encoded(), &encoded()->left};
}
std::shared_ptr<const EncodedStream> rightStream() {
  return {encoded(), &encoded()->right};
}

/// A picture's index in the content, by its pixels.
std::map<std::uint64_t, std::size_t> contentByDigest(const EncodedStream& stream) {
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

/// Camera on a free port, or the port given, that repeats its content for ever.
std::unique_ptr<SimulatedCamera> switchOn(std::shared_ptr<const EncodedStream> stream, std::uint16_t port) {
  SimulatedCameraSettings settings;
  settings.port = port;
  settings.password = kPassword;
  settings.repeat_after_ns = kTurn_ns;
  return std::make_unique<SimulatedCamera>(std::move(stream), settings);
}

RtspCameraSettings settingsFor(std::uint16_t port) {
  RtspCameraSettings settings;
  settings.url = "rtsp://127.0.0.1:" + std::to_string(port) + "/Streaming/Channels/101";
  settings.credentials = {"admin", kPassword};
  settings.connect_timeout = milliseconds(3000);
  settings.first_retry = milliseconds(50);
  settings.longest_retry = milliseconds(200);
  return settings;
}

/// Reads until `done` says so; false if that takes longer than `limit`.
template <typename Done>
bool readUntil(RtspCamera& camera, const Done& done, milliseconds limit) {
  const Clock::time_point deadline = Clock::now() + limit;
  Frame frame;
  while (Clock::now() < deadline) {
    const ReadOutcome outcome = camera.read(frame, milliseconds(100));
    if (done(outcome, frame)) return true;
  }
  return false;
}

bool readFrames(RtspCamera& camera, int count) {
  return readUntil(
      camera,
      [&](ReadOutcome outcome, const Frame&) { return outcome == ReadOutcome::frame && --count == 0; },
      milliseconds(8000));
}

bool readUntilState(RtspCamera& camera, CameraState state) {
  return readUntil(
      camera, [&](ReadOutcome, const Frame&) { return camera.health().state == state; }, milliseconds(5000));
}

class LiveTransport : public testing::TestWithParam<RtspTransport> {};

TEST_P(LiveTransport, PicturesArriveWholeInOrderAndWithTheInstantsOfTheirExposure) {
  const EncodedStream& stream = encoded()->left;
  const std::map<std::uint64_t, std::size_t> content = contentByDigest(stream);
  const auto server = switchOn(leftStream(), 0);
  RtspCameraSettings settings = settingsFor(server->port());
  settings.transport = GetParam();
  RtspCamera camera(settings);
  ASSERT_TRUE(readFrames(camera, 1));
  const std::int64_t epoch = nowNs() / 1000 * 1000 + 100'000'000;
  server->startContent(epoch);

  int checked = 0;
  std::optional<std::uint64_t> last_sequence;
  const bool enough = readUntil(
      camera,
      [&](ReadOutcome outcome, const Frame& frame) {
        if (outcome != ReadOutcome::frame) return false;
        EXPECT_EQ(frame.status, FrameStatus::good);
        if (last_sequence) {
          EXPECT_EQ(frame.sequence, *last_sequence + 1);
        }
        last_sequence = frame.sequence;
        const auto found = content.find(test::digest(frame.image));
        if (found == content.end() || found->second == 0) return false;  // the lead-in stands still
        if (frame.instant_source != InstantSource::sender_report) return false;
        const std::int64_t expected = epoch + stream.units[found->second].instant_ns;
        EXPECT_NEAR(static_cast<double>((frame.exposure_ns - expected) % kTurn_ns), 0.0, kTwoTicks_ns);
        EXPECT_GE(frame.decoded_ns, frame.arrival_ns);
        return ++checked == 40;
      },
      milliseconds(10000));
  EXPECT_TRUE(enough) << checked;
  EXPECT_EQ(camera.health().damaged, 0U);
  EXPECT_EQ(camera.health().reconnections, 0U);
  EXPECT_EQ(camera.health().state, CameraState::streaming);
}

std::string transportName(const testing::TestParamInfo<RtspTransport>& transport) {
  return transport.param == RtspTransport::tcp ? "Tcp" : "Udp";
}

INSTANTIATE_TEST_SUITE_P(RtspCamera, LiveTransport, testing::Values(RtspTransport::tcp, RtspTransport::udp),
                         transportName);

TEST(RtspCamera, ThePictureComesOutWithItsLastPacketNotWithTheNextPicture) {
  const EncodedStream& stream = encoded()->left;
  const std::map<std::uint64_t, std::size_t> content = contentByDigest(stream);
  SimulatedCameraSettings once;
  once.password = kPassword;
  SimulatedCamera server(leftStream(), once);
  RtspCamera camera(settingsFor(server.port()));
  ASSERT_TRUE(readFrames(camera, 1));
  server.startContent(nowNs());
  // No picture follows the last one, so only its own packets can have told that it is complete.
  EXPECT_TRUE(readUntil(
      camera,
      [&](ReadOutcome outcome, const Frame& frame) {
        if (outcome != ReadOutcome::frame) return false;
        const auto found = content.find(test::digest(frame.image));
        return found != content.end() && found->second + 1 == stream.units.size();
      },
      milliseconds(8000)));
}

TEST(RtspCamera, AWrongPasswordIsRefusedAndNeverShown) {
  std::mutex mutex;
  std::string log;
  setFfmpegLogSink([&](const std::string& message) {
    const std::lock_guard lock(mutex);
    log += message + "\n";
  });
  const auto server = switchOn(leftStream(), 0);
  RtspCameraSettings settings = settingsFor(server->port());
  settings.credentials.password = "hunter2";
  RtspCamera camera(settings);
  EXPECT_TRUE(readUntilState(camera, CameraState::refused));
  const CameraHealth health = camera.health();
  setFfmpegLogSink({});
  EXPECT_THAT(health.last_error, HasSubstr("refused the user or password (user 'admin')"));
  EXPECT_THAT(health.last_error, HasSubstr("; trying again in 30 s"));
  EXPECT_THAT(health.last_error, Not(HasSubstr("hunter2")));
  EXPECT_THAT(log, HasSubstr("401"));
  EXPECT_THAT(log, Not(HasSubstr("hunter2")));
  // Not asked again in a hurry: the account would be locked.
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(300)), ReadOutcome::timed_out);
  EXPECT_EQ(camera.health().state, CameraState::refused);
}

TEST(RtspCamera, AMissingPasswordIsSaidToBeMissing) {
  const auto server = switchOn(leftStream(), 0);
  RtspCameraSettings settings = settingsFor(server->port());
  settings.credentials = {};
  RtspCamera camera(settings);
  EXPECT_TRUE(readUntilState(camera, CameraState::refused));
  EXPECT_THAT(camera.health().last_error, HasSubstr("asks for a user and password, and none are configured"));
}

TEST(RtspCamera, ReconnectsToACameraThatWasSwitchedOffAndOn) {
  auto server = switchOn(leftStream(), 0);
  const std::uint16_t port = server->port();
  RtspCamera camera(settingsFor(port));
  Frame frame;
  ASSERT_TRUE(readFrames(camera, 10));
  server.reset();
  ASSERT_TRUE(readUntil(
      camera, [&](ReadOutcome, const Frame&) { return camera.health().state != CameraState::streaming; },
      milliseconds(5000)));
  EXPECT_THAT(camera.health().last_error, HasSubstr("127.0.0.1:" + std::to_string(port)));
  server = switchOn(leftStream(), port);
  EXPECT_TRUE(readFrames(camera, 10));
  EXPECT_EQ(camera.health().state, CameraState::streaming);
  EXPECT_EQ(camera.health().reconnections, 1U);
}

TEST(RtspCamera, NoticesThatTheStreamHasStalledAndConnectsAgain) {
  const auto server = switchOn(leftStream(), 0);
  test::TcpProxy proxy(server->port());
  RtspCameraSettings settings = settingsFor(proxy.port());
  settings.stall_timeout = milliseconds(300);
  RtspCamera camera(settings);
  ASSERT_TRUE(readFrames(camera, 10));
  proxy.freeze();
  ASSERT_TRUE(readUntilState(camera, CameraState::stalled));
  EXPECT_THAT(camera.health().last_error, HasSubstr("sent no picture for 300 ms"));
  EXPECT_TRUE(readFrames(camera, 5));
}

TEST(RtspCamera, SaysThatNothingListensThere) {
  std::uint16_t closed_port = 0;
  {
    const test::TcpProxy listener(1);
    closed_port = listener.port();
  }
  RtspCamera camera(settingsFor(closed_port));
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(200)), ReadOutcome::timed_out);
  EXPECT_THAT(camera.health().last_error, HasSubstr("Connection refused"));
  EXPECT_EQ(camera.health().state, CameraState::connecting);
}

TEST(RtspCamera, SaysThatNothingAnswersThere) {
  const int listener = ::socket(AF_INET, SOCK_STREAM, 0);  // the system accepts for it, nobody ever answers
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  ASSERT_EQ(::bind(listener, generic, size), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  ASSERT_EQ(::getsockname(listener, generic, &size), 0);
  RtspCameraSettings settings = settingsFor(ntohs(address.sin_port));
  settings.connect_timeout = milliseconds(300);
  RtspCamera camera(settings);
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(100)), ReadOutcome::timed_out);
  EXPECT_THAT(camera.health().last_error, HasSubstr("no answer from the camera at 127.0.0.1"));
  EXPECT_THAT(camera.health().last_error, HasSubstr("within 300 ms"));
  ::close(listener);
}

TEST(RtspCamera, InterruptEndsReadingInEachState) {
  const auto server = switchOn(leftStream(), 0);
  test::TcpProxy proxy(server->port());
  // Frozen before it is asked, the proxy accepts the connection and never answers.
  for (const bool answers : {true, false}) {
    RtspCamera camera(settingsFor(proxy.port()));
    if (!answers) proxy.freeze();
    std::atomic<bool> ended = false;
    std::thread reader([&] {
      Frame frame;
      while (camera.read(frame, milliseconds(10000)) != ReadOutcome::ended)
        continue;
      ended = true;
    });
    std::this_thread::sleep_for(milliseconds(300));
    EXPECT_FALSE(ended);
    camera.interrupt();
    reader.join();
    EXPECT_EQ(camera.health().state, CameraState::ended);
    Frame frame;
    EXPECT_EQ(camera.read(frame, milliseconds(1000)), ReadOutcome::ended);
  }
}

TEST(RtspCamera, ARecordingOfALiveStreamReplaysTheSameFrames) {
  const test::TemporaryFolder folder;
  const auto server = switchOn(leftStream(), 0);
  struct Seen {
    std::uint64_t sequence;
    std::int64_t exposure_ns;
    std::int64_t arrival_ns;
    InstantSource source;
    FrameStatus status;
    std::uint64_t pixels;
    bool operator==(const Seen&) const = default;
  };
  const auto seen = [](const Frame& f) {
    return Seen{f.sequence, f.exposure_ns, f.arrival_ns, f.instant_source, f.status, test::digest(f.image)};
  };
  std::vector<Seen> live;
  {
    StreamRecorder recorder({folder / "drive", "", ""});
    RtspCamera camera(settingsFor(server->port()));
    camera.observe(recorder.left());
    server->startContent(nowNs());
    ASSERT_TRUE(readUntil(
        camera,
        [&](ReadOutcome outcome, const Frame& frame) {
          if (outcome == ReadOutcome::frame) live.push_back(seen(frame));
          return live.size() == 50;
        },
        milliseconds(8000)));
    EXPECT_EQ(recorder.health().error, "");
  }
  std::vector<Seen> replayed;
  RecordingSource source(folder / "drive", "left");
  Frame frame;
  while (source.read(frame, milliseconds(0)) == ReadOutcome::frame)
    replayed.push_back(seen(frame));
  ASSERT_GE(replayed.size(), live.size());  // the last picture may have been received but not read
  replayed.resize(live.size());
  EXPECT_EQ(replayed, live);
}

TEST(RtspCamera, TwoCamerasPairWithTheirTrueOffset) {
  const auto left = switchOn(leftStream(), 0);
  const auto right = switchOn(rightStream(), 0);
  const std::int64_t epoch = nowNs() / 1000 * 1000 + 1'000'000'000;
  left->startContent(epoch);
  right->startContent(epoch);

  PairSynchroniser synchroniser({});
  std::mutex mutex;
  std::vector<FramePair> pairs;
  const auto feed = [&](CameraSide side, std::uint16_t port) {
    RtspCamera camera(settingsFor(port));
    readUntil(
        camera,
        [&](ReadOutcome outcome, Frame frame) {
          const std::lock_guard lock(mutex);
          if (outcome == ReadOutcome::frame) synchroniser.push(side, std::move(frame));
          while (std::optional<FramePair> pair = synchroniser.pop()) {
            if (pair->left.exposure_ns > epoch) pairs.push_back(std::move(*pair));
          }
          return pairs.size() > 40;
        },
        milliseconds(9000));
  };
  std::thread other([&] { feed(CameraSide::right, right->port()); });
  feed(CameraSide::left, left->port());
  other.join();
  int exact = 0;
  for (const FramePair& pair : pairs) {
    EXPECT_LE(std::abs(pair.offsetNs()), 20'000'000);
    if (pair.left.instant_source != InstantSource::sender_report) continue;
    EXPECT_NEAR(static_cast<double>(pair.offsetNs()), static_cast<double>(kOffset_ns), kTwoTicks_ns);
    ++exact;
  }
  EXPECT_GT(exact, 10);
}

}  // namespace
}  // namespace cartvo
