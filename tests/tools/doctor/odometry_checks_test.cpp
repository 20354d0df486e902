// Processing of a few pairs.
#include "tools/doctor/odometry_checks.hpp"

#include <atomic>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/capture/synthetic_cameras.hpp"
#include "support/doctor/findings.hpp"

namespace cartvo::doctor {
namespace {

using test::findingOf;
using test::Saw;

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
