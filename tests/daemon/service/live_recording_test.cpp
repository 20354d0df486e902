// Where a recording can be written, before the cart drives.
#include "daemon/service/live_recording.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace cartvo::daemon {
namespace {

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

}  // namespace
}  // namespace cartvo::daemon
