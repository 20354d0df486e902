// Checks of recordings, good and bad ones.
#include "tools/doctor/recording_checks.hpp"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/doctor/findings.hpp"
#include "support/doctor/walls.hpp"
#include "support/temporary_folder.hpp"
#include "tools/doctor/cameras/stream_checks.hpp"

namespace cartvo::doctor {
namespace {

using test::findingOf;
using test::Saw;

class RecordingChecks : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::atomic<bool> interrupted_{false};
  FindingList list_{"source"};
};

TEST_F(RecordingChecks, ReadAWholeRecording) {
  test::recordWalls(folder_ / "drive");
  checkRecording(folder_ / "drive", list_);
  EXPECT_THAT(findingOf(list_.findings(), "recording"), Saw(Verdict::ok, "1 segment,"));
  EXPECT_THAT(findingOf(list_.findings(), "right camera"), Saw(Verdict::ok, "60 pictures in 3.0 s"));
  int last_second = -1;
  const auto progress = [&](int done, int) { last_second = done; };
  const SourceContent content = readSource(folder_ / "drive", progress, interrupted_, list_);
  EXPECT_EQ(last_second, 2);
  ASSERT_TRUE(content.rig);
  EXPECT_EQ(content.rig->name, "test");
  EXPECT_EQ(content.pairs.consecutive.size(), 40U);
  EXPECT_EQ(content.pairs.spread.size(), 12U);
  EXPECT_EQ(worstVerdict(list_.findings()), Verdict::ok) << areaText(list_.findings());
}

TEST_F(RecordingChecks, MeasureItsStreams) {
  test::recordWalls(folder_ / "drive");
  const StreamMeasurement whole =
      measureRecording(folder_ / "drive", capture::CameraSide::left, 10.0, interrupted_);
  EXPECT_EQ(whole.pictures.size(), 60U);
  checkStream(whole, {{320, 240}, test::kWallsRate}, list_);
  EXPECT_THAT(findingOf(list_.findings(), "frame rate"), Saw(Verdict::ok, "20.000 Hz"));
  EXPECT_THAT(findingOf(list_.findings(), "clock"), Saw(Verdict::ok, "+20.0 ms"));
  EXPECT_EQ(measureRecording(folder_ / "drive", capture::CameraSide::left, 1.0, interrupted_).pictures.size(),
            21U);
}

TEST_F(RecordingChecks, FindWhatIsNoRecording) {
  checkRecording(folder_ / "nothing", list_);
  EXPECT_EQ(list_.findings().back().verdict, Verdict::broken);
  std::filesystem::create_directory(folder_ / "damaged");
  std::ofstream(folder_ / "damaged/recording.json") << "{";
  checkRecording(folder_ / "damaged", list_);
  EXPECT_THAT(list_.findings().back(), Saw(Verdict::broken, "recording.json"));
  EXPECT_TRUE(readSource(
                  folder_.path(), [](int, int) {}, interrupted_, list_)
                  .pairs.spread.empty());
  EXPECT_EQ(list_.findings().back().verdict, Verdict::broken);
  EXPECT_NE(measureRecording(folder_ / "nothing", capture::CameraSide::left, 1.0, interrupted_).problem, "");
}

}  // namespace
}  // namespace cartvo::doctor
