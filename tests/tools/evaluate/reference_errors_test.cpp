// Error measures equal to those of KITTI's devkit and of evo, by numbers that reference_errors.py computed
// from their published definitions alone.
#include <cmath>

#include <gtest/gtest.h>

#include "common/units.hpp"
#include "tools/evaluate/association.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace cartvo {
namespace {

constexpr int kPoses = 1500;

/// As motion() in reference_errors.py.
Eigen::Isometry3d motion(double forward, double yaw, double pitch) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  pose.translation().z() = forward;
  return pose;
}

/// As trajectories() in reference_errors.py.
AssociatedTrajectories example() {
  Trajectory truth(1), estimate(1);
  for (int i = 1; i < kPoses; ++i) {
    const double forward = 0.7 + 0.2 * std::sin(0.05 * i), yaw = 0.02 * std::sin(0.011 * i),
                 pitch = 0.003 * std::cos(0.07 * i);
    truth.push_back({i, truth.back().pose * motion(forward, yaw, pitch)});
    estimate.push_back({i, estimate.back().pose * motion(1.01 * forward + 0.004 * std::cos(0.3 * i),
                                                         yaw + 0.0004 * std::sin(0.9 * i) + 0.0001,
                                                         pitch + 0.0001 * std::cos(i))});
  }
  return associateByRows(estimate, truth);
}

void expectNear(const SegmentErrors& errors, const SegmentErrors& reference) {
  EXPECT_EQ(errors.count, reference.count) << reference.length << " m";
  EXPECT_NEAR(errors.translation, reference.translation, 1e-9) << reference.length << " m";
  EXPECT_NEAR(errors.rotation, reference.rotation, 1e-9) << reference.length << " m";
}

TEST(ReferenceErrors, SegmentsAreThoseOfTheDevkitOfKitti) {
  const std::vector<SegmentErrors> reference{
      {100, 136, 0.0102881488641, 0.00014407401991},  {200, 121, 0.011251346438, 0.000143439283428},
      {300, 106, 0.0120515778996, 0.000142921636815}, {400, 92, 0.012558534404, 0.000142792453217},
      {500, 79, 0.0142150134784, 0.000142649770433},  {600, 65, 0.0161292128368, 0.000142680600886},
      {700, 50, 0.018915888694, 0.000142798881969},   {800, 36, 0.0207979405726, 0.000142912592517}};
  const SegmentGroup segments = evaluate(example()).long_segments;
  ASSERT_EQ(segments.each.size(), reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i)
    expectNear(segments.each[i], reference[i]);
  expectNear(segments.all, {0, 685, 0.0132253412869, 0.00014316085774});
}

TEST(ReferenceErrors, AbsoluteAndRelativeErrorsAreThoseOfEvo) {
  const Evaluation evaluation = evaluate(example());
  EXPECT_NEAR(evaluation.absolute_aligned, 3.37818148337, 1e-7);
  EXPECT_NEAR(evaluation.relative_translation, 0.00767838658602, 1e-10);
  EXPECT_NEAR(kDegreesPerRadian * evaluation.relative_rotation, 0.0176674826294, 1e-10);
}

}  // namespace
}  // namespace cartvo
