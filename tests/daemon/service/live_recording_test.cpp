// Where a recording can be written, before the cart drives. Recordings that start and stop while the
// cameras stream.
#include "daemon/service/live_recording.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/service/recording_switch.hpp"
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

}  // namespace
}  // namespace cartvo::daemon
