// Checks of a drive: of its recording and of the odometry in it.
#include "tools/doctor/recording_checks.hpp"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/capture/synthetic_cameras.hpp"
#include "support/doctor/findings.hpp"
#include "support/doctor/walls.hpp"
#include "support/temporary_folder.hpp"
#include "tools/doctor/cameras/stream_checks.hpp"
#include "tools/doctor/odometry_checks.hpp"

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

std::vector<capture::FramePair> wallPairs(int count, std::int64_t period_ns) {
  std::vector<capture::FramePair> pairs;
  for (int i = 0; i < count; ++i)
    pairs.push_back({test::wallFrame(i, 0, i * period_ns), test::wallFrame(i, 12, i * period_ns)});
  return pairs;
}

Findings checked(const std::vector<capture::FramePair>& pairs, const calib::Rig& rig) {
  const std::atomic<bool> interrupted{false};
  FindingList list("odometry");
  checkProcessing(
      pairs, {rig, {}, 1, pipeline::AbsentReadout::global_shutter}, [](int, int) {}, interrupted, list);
  return list.take();
}

TEST(OdometryChecks, CompareTheProcessingTimeWithTheFramePeriod) {
  const Findings slow_cameras = checked(wallPairs(8, 1'000'000'000), test::smallRig());
  EXPECT_THAT(findingOf(slow_cameras, "processing time"), Saw(Verdict::ok, "frame period of 1000.0 ms"));
  const Findings fast_cameras = checked(wallPairs(8, 1'000), test::smallRig());
  EXPECT_THAT(findingOf(fast_cameras, "processing time"), Saw(Verdict::broken, "frame period of 0.0 ms"));
}

TEST(OdometryChecks, SayWhetherTheMotionIsValid) {
  EXPECT_THAT(findingOf(checked(wallPairs(12, 50'000'000), test::smallRig()), "odometry"),
              Saw(Verdict::ok, "of 12 pairs valid"));
  std::vector<capture::FramePair> dark = wallPairs(12, 50'000'000);
  for (capture::FramePair& pair : dark)
    pair.left.image = pair.right.image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(3));
  EXPECT_THAT(findingOf(checked(dark, test::smallRig()), "odometry"), Saw(Verdict::broken, "0 of "));
}

TEST(OdometryChecks, NeedSomePairs) {
  EXPECT_THAT(checked({}, test::smallRig()).front(), Saw(Verdict::not_checked, "0 pairs"));
}

TEST(OdometryChecks, FindPicturesOfAnotherSize) {
  calib::Rig rig = test::smallRig();
  rig.left.size = rig.right.size = {640, 480};
  rig.left.distortion[0] = 0.01;
  EXPECT_THAT(findingOf(checked(wallPairs(8, 50'000'000), rig), "odometry"), Saw(Verdict::broken, "320x240"));
}

}  // namespace
}  // namespace cartvo::doctor
