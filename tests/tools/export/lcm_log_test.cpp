// Tests of event logs of LCM, played back by LCM's own reader.
#include "tools/export/lcm_log.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/exported_drive.hpp"

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

TEST(LcmLog, IsNotLeftHalfWritten) {
  std::ofstream full("/dev/full");
  if (!full) GTEST_SKIP() << "no /dev/full here";
  EXPECT_THAT(test::messageOf([] { writeLcmLog("/dev/full", *test::drivenSource().replay); }),
              HasSubstr("/dev/full: is not a regular file"));
}

}  // namespace
}  // namespace cartvo
