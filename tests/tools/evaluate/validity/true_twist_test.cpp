// Velocities and rates from true poses.
#include "tools/evaluate/validity/true_twist.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

/// A cart that swings: 2 m/s forward, and an oscillation of `hz` in all axes.
Eigen::Isometry3d poseAt(double t, double hz) {
  const double phase = 2.0 * std::numbers::pi * hz * t;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::AngleAxisd(0.1 * std::sin(phase) + 0.3 * t, Eigen::Vector3d(1, 2, 2) / 3.0).toRotationMatrix();
  pose.translation() << 2.0 * t, 0.05 * std::sin(phase), 0.02 * std::cos(phase);
  return pose;
}

vo::Vector6d twistAt(double t, double hz) {
  const double omega = 2.0 * std::numbers::pi * hz, phase = omega * t;
  vo::Vector6d twist;
  twist << poseAt(t, hz).linear().transpose() *
               Eigen::Vector3d(2.0, 0.05 * omega * std::cos(phase), -0.02 * omega * std::sin(phase)),
      (0.1 * omega * std::cos(phase) + 0.3) * Eigen::Vector3d(1, 2, 2) / 3.0;
  return twist;
}

Trajectory sampled(double rate, double seconds, double hz) {
  Trajectory truth;
  for (int i = 0; i < static_cast<int>(rate * seconds); ++i)
    truth.push_back({std::llround(1e9 * i / rate), poseAt(i / rate, hz)});
  return truth;
}

/// Largest error of a component at instants between and at the poses.
double largestError(double rate, double hz) {
  const TrueTwist truth(sampled(rate, 4.0, hz));
  double largest = 0.0;
  for (double t = 0.5; t < 3.5; t += 0.0037)
    largest =
        std::max(largest, (truth.at(std::llround(1e9 * t)).value() - twistAt(t, hz)).cwiseAbs().maxCoeff());
  return largest;
}

TEST(TrueTwist, IsThatOfTheMotionAtAndBetweenPoses) {
  EXPECT_LT(largestError(18.0, 0.5), 0.001);
  EXPECT_LT(largestError(90.0, 2.0), 0.002) << "thinned to 45 Hz";
}

TEST(TrueTwist, ResolvesWhatItsRateAllows) {
  const double amplitude = 0.1 * 2.0 * std::numbers::pi * 5.0;  // of the rate about the axis
  EXPECT_LT(largestError(18.0, 5.0), 0.15 * amplitude);
  EXPECT_GT(largestError(18.0, 5.0), 0.02 * amplitude) << "a truth at 18 Hz is no reference for 5 Hz";
}

TEST(TrueTwist, IsUnknownAtTheEndsAndInGaps) {
  Trajectory poses = sampled(18.0, 6.0, 0.5);
  poses.erase(poses.begin() + 40, poses.begin() + 60);
  const TrueTwist truth(poses);
  EXPECT_FALSE(truth.at(poses.front().time_ns));
  EXPECT_TRUE(truth.at(poses[1].time_ns));
  EXPECT_TRUE(truth.at(poses[38].time_ns));
  EXPECT_FALSE(truth.at(poses[39].time_ns + 500'000'000)) << "more than a second without a pose";
  EXPECT_TRUE(truth.at(poses[42].time_ns));
  EXPECT_FALSE(truth.at(poses.back().time_ns));
}

}  // namespace
}  // namespace cartvo
