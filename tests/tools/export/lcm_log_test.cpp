// Tests of event logs of LCM, played back by LCM's own reader.
#include "tools/export/lcm_log.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/exported_drive.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;

TEST(LcmLog, HasEachMessageAtItsArrival) {
  const test::TemporaryFolder folder;
  const Replay replay = *test::drivenSource().replay;
  writeLcmLog(folder / "drive.lcmlog", replay);
  lcm::LogFile log((folder / "drive.lcmlog").string(), "r");
  ASSERT_TRUE(log.good());
  std::size_t index = 0;
  for (const lcm::LogEvent* event = log.readNextEvent(); event != nullptr; event = log.readNextEvent()) {
    ASSERT_LT(index, replay.pairs.size());
    const odometry_t& expected = replay.pairs[index].message;
    EXPECT_EQ(event->channel, "CARTVO_ODOMETRY");
    EXPECT_EQ(event->timestamp, expected.arrival_utime);
    odometry_t message{};
    ASSERT_EQ(message.decode(event->data, 0, event->datalen), event->datalen);
    EXPECT_EQ(message.utime, expected.utime);
    EXPECT_EQ(message.sequence, static_cast<std::int64_t>(index));
    EXPECT_EQ(message.publication_utime, event->timestamp);
    EXPECT_GT(message.time_to_live_us, 0);
    EXPECT_EQ(message.status, expected.status);
    EXPECT_EQ(message.angular_velocity_body[2], expected.angular_velocity_body[2]);
    ++index;
  }
  EXPECT_EQ(index, replay.pairs.size());
}

TEST(LcmLog, OfAnImageFolderHasTheExposures) {
  const test::TemporaryFolder folder;
  Replay replay = *test::drivenSource().replay;
  for (ReplayedPair& pair : replay.pairs)
    pair.message.arrival_utime = 0;
  writeLcmLog(folder / "drive.lcmlog", replay);
  lcm::LogFile log((folder / "drive.lcmlog").string(), "r");
  EXPECT_EQ(log.readNextEvent()->timestamp, test::kDriveStart_ns / 1000);
}

/// Runs a command in a network namespace with loopback only.
test::CommandResult runIsolated(const std::string& command) {
  const std::string isolated = (test::sourceFolder() / "tools/in_network_namespace").string();
  return test::runCommand(isolated + " sh -c '" + command + "' 2>&1");
}

TEST(LcmLog, IsPlayedByTheLogplayerAndRecordedByTheLogger) {
  if (runIsolated("true").exit_code != 0) GTEST_SKIP() << "no network namespace of its own here";
  const test::TemporaryFolder folder;
  writeLcmLog(folder / "drive.lcmlog", *test::drivenSource().replay);
  // The logger may start after the first playing, so it is repeated until the logger has recorded something.
  const test::CommandResult run =
      runIsolated("cd " + folder.path().string() +
                  "; lcm-logger --force --quiet --flush-interval=1 live.lcmlog >/dev/null & logger=$!; "
                  "for i in $(seq 100); do lcm-logplayer drive.lcmlog; test -s live.lcmlog && break; done; "
                  "kill -INT $logger; wait");
  lcm::LogFile log((folder / "live.lcmlog").string(), "r");
  ASSERT_TRUE(log.good()) << run.output;
  const lcm::LogEvent* event = log.readNextEvent();
  ASSERT_NE(event, nullptr) << run.output;
  EXPECT_EQ(event->channel, "CARTVO_ODOMETRY");
  odometry_t message{};
  EXPECT_EQ(message.decode(event->data, 0, event->datalen), event->datalen);
}

TEST(LcmLog, IsNotLeftHalfWritten) {
  std::ofstream full("/dev/full");
  if (!full) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THAT(test::messageOf([] { writeLcmLog("/dev/full", *test::drivenSource().replay); }),
              HasSubstr("/dev/full: is not a regular file"));
}

}  // namespace
}  // namespace cartvo
