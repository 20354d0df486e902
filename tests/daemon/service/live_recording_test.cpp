// Where a recording can be written, before the cart drives. Recordings that start and stop while the
// cameras stream.
#include "daemon/service/live_recording.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/service/live_camera.hpp"
#include "support/camera/isapi_server.hpp"
#include "support/closed_port.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "tests/support/capture/recorded_units.hpp"

namespace cartvo::daemon {
namespace {

using capture::CameraSide;
using test::recordedSequences, test::settingsFor, test::unitAt;
using testing::HasSubstr;

class RecordingObstacleTest : public testing::Test {
 protected:
  RecordingObstacleTest() { std::ofstream(folder_ / "file") << "text"; }

  /// As with recording.directory.
  std::string obstacleBelow(const std::filesystem::path& recordings) const {
    Configuration configuration;
    configuration.recording_quota.recordings = recordings;
    configuration.recording_directory = recordings / "start";
    return recordingObstacle(configuration);
  }

  /// As with --record.
  std::string obstacleTo(const std::filesystem::path& folder) const {
    Configuration configuration;
    configuration.recording_directory = folder;
    return recordingObstacle(configuration);
  }

  test::TemporaryFolder folder_;
};

TEST_F(RecordingObstacleTest, IsAFileOnTheWay) {
  EXPECT_THAT(obstacleBelow(folder_ / "file"), HasSubstr("is no folder"));
  EXPECT_THAT(obstacleTo(folder_.path() / "file" / "below"), HasSubstr("is no folder"));
  EXPECT_THAT(obstacleTo(folder_ / "file"), HasSubstr("is no folder"));
}

TEST_F(RecordingObstacleTest, IsAFolderWithFilesForOneRecording) {
  EXPECT_THAT(obstacleTo(folder_.path()), HasSubstr("is not empty"));
  EXPECT_EQ(obstacleBelow(folder_.path()), "");
}

TEST_F(RecordingObstacleTest, IsNoneWhereFoldersCanBeMade) {
  EXPECT_EQ(obstacleTo(folder_.path() / "new" / "below"), "");
  EXPECT_EQ(obstacleBelow(folder_.path() / "new"), "");
  EXPECT_EQ(recordingObstacle({}), "");
}

void stream(RecordingSwitch& recordings, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    recordings.left().onUnit(unitAt(i));
    recordings.right().onUnit(unitAt(i));
  }
}

TEST(RecordingSwitch, RecordsBetweenStartAndStopEachTimeIntoItsFolder) {
  const test::TemporaryFolder folder;
  RecordingSwitch recordings;
  recordings.left().onStream({capture::VideoCodec::h264, {}});
  recordings.right().onStream({capture::VideoCodec::h264, {}});
  stream(recordings, 0, 20);
  EXPECT_EQ(recordings.current().recorder, nullptr);

  recordings.start(settingsFor(folder / "first"));
  EXPECT_NE(recordings.current().recorder, nullptr);
  stream(recordings, 20, 50);
  recordings.stop();
  stream(recordings, 50, 60);
  EXPECT_EQ(recordings.current().recorder, nullptr);
  EXPECT_EQ(recordings.current().folder, folder / "first");
  for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
    const std::vector<std::uint64_t> recorded = recordedSequences(folder / "first", side);
    ASSERT_FALSE(recorded.empty()) << "within a connection, without another onStream()";
    EXPECT_EQ(recorded.front(), 30U) << "the next key picture";
    EXPECT_EQ(recorded.back(), 49U);
  }

  recordings.start(settingsFor(folder / "second"));
  stream(recordings, 60, 90);
  recordings.stop();
  EXPECT_EQ(recordedSequences(folder / "second", CameraSide::left).front(), 60U);
}

TEST(RecordingSwitch, DoesNothingTwice) {
  const test::TemporaryFolder folder;
  RecordingSwitch recordings;
  EXPECT_FALSE(recordings.stop());
  EXPECT_TRUE(recordings.start(settingsFor(folder / "first")));
  EXPECT_FALSE(recordings.start(settingsFor(folder / "second")));
  EXPECT_EQ(recordings.current().folder, folder / "first");
  EXPECT_FALSE(std::filesystem::exists(folder / "second"));
  EXPECT_TRUE(recordings.stop());
  EXPECT_FALSE(recordings.stop());
}

TEST(RecordingSwitch, ThrowsIfTheFolderHasARecording) {
  const test::TemporaryFolder folder;
  RecordingSwitch recordings;
  recordings.start(settingsFor(folder / "first"));
  recordings.stop();
  EXPECT_THROW(recordings.start(settingsFor(folder / "first")), std::runtime_error);
  EXPECT_EQ(recordings.current().recorder, nullptr);
}

using testing::HasSubstr;

Configuration rtspAndV4l2() {
  Configuration configuration;
  configuration.left.url = "rtsp://127.0.0.1:1/left";
  configuration.right.url = "v4l2:/dev/nonexistent/video7";
  configuration.frame_rate = 25.0;
  return configuration;
}

class NullObserver : public capture::StreamObserver {
 public:
  void onStream(const capture::StreamFormat& /*format*/) noexcept override {}
  void onUnit(const capture::EncodedUnit& /*unit*/) noexcept override {}
};

TEST(LiveCamera, IsRtspOrV4l2CameraByUrl) {
  capture::StereoTimestamper clock(capture::ClockChoice::automatic);
  LiveCamera left(rtspAndV4l2(), capture::CameraSide::left, {680, 420}, clock);
  LiveCamera right(rtspAndV4l2(), capture::CameraSide::right, {680, 420}, clock);
  NullObserver observer;
  EXPECT_TRUE(left.observe(observer));
  EXPECT_FALSE(right.observe(observer)) << "V4L2 cameras have no encoded stream";
  EXPECT_EQ(left.source().health().instant_source, capture::InstantSource::arrival);
  EXPECT_EQ(right.source().health().instant_source, capture::InstantSource::kernel);
}

TEST(LiveCamera, ReaderTimeoutIsTwiceTheCameraTimeouts) {
  Configuration configuration = rtspAndV4l2();
  capture::StereoTimestamper clock(capture::ClockChoice::automatic);
  EXPECT_EQ(LiveCamera(configuration, capture::CameraSide::left, {}, clock).readerTimeout(), 14.0)
      << "twice the connection time-out and the answer time-outs of RTSP and, after a refusal, of HTTP";
  configuration.stall_timeout = std::chrono::seconds(60);
  EXPECT_EQ(LiveCamera(configuration, capture::CameraSide::left, {}, clock).readerTimeout(), 120.0)
      << "twice the stall time-out, which is longer";
  EXPECT_EQ(LiveCamera(configuration, capture::CameraSide::right, {680, 420}, clock).readerTimeout(), 120.0);
}

TEST(LiveCamera, UsesConfiguredTimeouts) {
  Configuration configuration = rtspAndV4l2();
  configuration.answer_timeout = std::chrono::milliseconds(300);
  configuration.connect_timeout = std::chrono::milliseconds(700);
  configuration.stall_timeout = std::chrono::milliseconds(400);
  const capture::RtspCameraSettings settings = rtspSettings(configuration, configuration.left);
  EXPECT_EQ(settings.answer_timeout, configuration.answer_timeout);
  EXPECT_EQ(settings.connect_timeout, configuration.connect_timeout);
  EXPECT_EQ(settings.stall_timeout, configuration.stall_timeout);
  capture::StereoTimestamper clock(capture::ClockChoice::automatic);
  EXPECT_EQ(LiveCamera(configuration, capture::CameraSide::left, {}, clock).readerTimeout(), 2.6)
      << "twice the connection time-out and both answer time-outs";
}

TEST(LiveCamera, V4l2CameraUsesRigSizeUnlessConfigured) {
  Configuration configuration = rtspAndV4l2();
  EXPECT_EQ(v4l2Settings(configuration, configuration.right, {680, 420}).size, cv::Size(680, 420));
  EXPECT_THAT(test::messageOf([&] { v4l2Settings(configuration, configuration.right, {}); }),
              HasSubstr("cameras.right.size is missing"));
  configuration.right.size = {1280, 720};
  configuration.right.exposure = 0.004;
  const capture::V4l2CameraSettings settings = v4l2Settings(configuration, configuration.right, {680, 420});
  EXPECT_EQ(settings.size, cv::Size(1280, 720));
  EXPECT_EQ(settings.device, "/dev/nonexistent/video7");
  EXPECT_EQ(settings.frame_rate, 25.0);
  EXPECT_EQ(settings.exposure, 0.004);
}

capture::RefusedLogin ask(int port) {
  const std::atomic<bool> interrupted = false;
  return askAboutRefusedLogin({"127.0.0.1", static_cast<std::uint16_t>(port), false},
                              std::chrono::seconds(10), interrupted);
}

TEST(RefusedLogin, TellsForHowLongTheCameraHasLockedIt) {
  test::CameraHabits habits;
  habits.is_locked = true;
  const test::IsapiServer server(habits);
  const capture::RefusedLogin refusal = ask(server.port());
  EXPECT_EQ(refusal.locked_for, std::chrono::seconds(1799));
  EXPECT_THAT(refusal.text, HasSubstr("locked this login for another 1799 s"));
  EXPECT_THAT(server.received(), testing::Not(HasSubstr("Authorization")));
}

TEST(RefusedLogin, TellsHowManyAttemptsAreLeft) {
  const test::IsapiServer server;
  const capture::RefusedLogin refusal = ask(server.port());
  EXPECT_EQ(refusal.locked_for, std::nullopt);
  EXPECT_THAT(refusal.text, HasSubstr("5 attempts are left"));
}

TEST(RefusedLogin, IsEmptyForOtherDevices) {
  test::CameraHabits habits;
  habits.knows_user_check = false;
  const test::IsapiServer server(habits);
  EXPECT_EQ(ask(server.port()).text, "");
  const test::ClosedPort closed;
  EXPECT_EQ(ask(closed.port()).text, "") << "nothing answers";
}

}  // namespace

}  // namespace cartvo::daemon
