// Tests of projections and of the interpolated right camera; derivatives are compared with central
// differences.
#include "vo_core/geometry/reprojection.hpp"

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"

namespace cartvo::vo {
namespace {

using test::kRigCamera;
using test::steadyDrive;
using test::vector6;

constexpr double kStep = 1e-6;

/// Derivative of `value(x)` at zero; x has kInputs elements.
template <int kInputs, typename Value>
auto centralDifference(const Value& value) {
  using Input = Eigen::Matrix<double, kInputs, 1>;
  constexpr int kOutputs = decltype(value(Input()))::RowsAtCompileTime;
  Eigen::Matrix<double, kOutputs, kInputs> derivative;
  for (int i = 0; i < kInputs; ++i) {
    const Input step = kStep * Input::Unit(i);
    derivative.col(i) = (value(step) - value(-step)) / (2.0 * kStep);
  }
  return derivative;
}

struct View {
  Eigen::Isometry3d T_world_anchor = motionFromVector(vector6(0.3, -0.1, 0.2, 0.05, -0.1, 0.02));
  Eigen::Isometry3d T_world_camera = motionFromVector(vector6(0.5, 0.1, 1.1, -0.03, 0.12, 0.04));
  Eigen::Vector3d bearing{0.2, -0.15, 1.0};
  double inverse_depth = 0.2;

  Eigen::Isometry3d fromAnchor() const { return T_world_camera.inverse() * T_world_anchor; }
  Projection projection() const { return projectLandmark(kRigCamera, fromAnchor(), bearing, inverse_depth); }
};

void expectExactJacobians(const View& view) {
  ASSERT_TRUE(view.projection().valid);
  const ProjectionJacobians by =
      projectionJacobians(kRigCamera, view.fromAnchor(), view.bearing, view.inverse_depth, view.projection());
  const auto pixel = [&](const auto& change, const auto& delta) {
    View changed = view;
    change(changed, delta);
    return changed.projection().pixel;
  };
  const auto by_camera = centralDifference<6>([&](const Vector6d& v) -> Eigen::Vector2d {
    return pixel(
        [](View& to, const Vector6d& d) { to.T_world_camera = to.T_world_camera * motionFromVector(d); }, v);
  });
  const auto by_anchor = centralDifference<6>([&](const Vector6d& v) -> Eigen::Vector2d {
    return pixel(
        [](View& to, const Vector6d& d) { to.T_world_anchor = to.T_world_anchor * motionFromVector(d); }, v);
  });
  const auto by_bearing = centralDifference<3>([&](const Eigen::Vector3d& v) -> Eigen::Vector2d {
    return pixel([](View& to, const Eigen::Vector3d& d) { to.bearing += d; }, v);
  });
  const auto by_depth = centralDifference<1>([&](const Eigen::Matrix<double, 1, 1>& v) -> Eigen::Vector2d {
    return pixel([](View& to, const auto& d) { to.inverse_depth += d[0]; }, v);
  });
  EXPECT_LT((by.by_camera - by_camera).norm(), 1e-4);  // of some 500 px per rad
  EXPECT_LT((by.by_anchor - by_anchor).norm(), 1e-4);
  EXPECT_LT((by.by_bearing - by_bearing).norm(), 1e-4);
  EXPECT_LT((by.by_inverse_depth - by_depth).norm(), 1e-4);
}

TEST(Reprojection, JacobiansAgreeWithDifferences) {
  expectExactJacobians(View{});
}

TEST(Reprojection, JacobiansAgreeWithDifferencesNearTheCameraAndAtTheImagesEdge) {
  View view;
  view.bearing = {-0.7, 0.42, 1.0};
  view.inverse_depth = 0.6;
  expectExactJacobians(view);
}

TEST(Reprojection, JacobiansAgreeWithDifferencesAtInfinity) {
  View view;
  view.inverse_depth = 0.0;
  expectExactJacobians(view);
}

TEST(Reprojection, AgreesWithTheProjectionOfThePoint) {
  const View view;
  const Eigen::Vector3d point = view.fromAnchor() * (view.bearing / view.inverse_depth);
  EXPECT_LT((view.projection().pixel - project(kRigCamera, point)).norm(), 1e-9);
}

TEST(Reprojection, PointAtInfinityIsIndependentOfTranslation) {
  View view;
  view.inverse_depth = 0.0;
  const Eigen::Vector2d before = view.projection().pixel;
  view.T_world_camera.translation() += Eigen::Vector3d(5.0, -3.0, 100.0);
  EXPECT_TRUE(view.projection().valid);
  EXPECT_LT((view.projection().pixel - before).norm(), 1e-9);
}

TEST(Reprojection, RejectsPointsBehindTheCamera) {
  View view;
  view.T_world_camera.translation().z() += 20.0;
  EXPECT_FALSE(view.projection().valid);
}

TEST(Reprojection, BearingsAreProjectedBackToTheirPixels) {
  const Eigen::Vector2d pixel(123.25, 317.5);
  EXPECT_LT((project(kRigCamera, 7.0 * bearingOf(kRigCamera, pixel)) - pixel).norm(), 1e-9);
}

TEST(Reprojection, RightJacobianOfRotationAgreesWithDifferences) {
  for (const double angle : {0.0, 9e-6, 1.1e-5, 0.01, 1.0, 2.5}) {
    const Eigen::Vector3d rotation = angle * Eigen::Vector3d(0.6, -0.48, 0.64);
    const auto turned = [&](const Eigen::Vector3d& delta) {
      Vector6d vector = Vector6d::Zero();
      vector.tail<3>() = rotation + delta;
      return motionFromVector(vector);
    };
    const Eigen::Isometry3d before = turned(Eigen::Vector3d::Zero());
    const auto expected = centralDifference<3>([&](const Eigen::Vector3d& delta) -> Eigen::Vector3d {
      return vectorFromMotion(before.inverse() * turned(delta)).tail<3>();
    });
    EXPECT_LT((rightJacobianOfRotation(rotation) - expected).norm(), 1e-8) << angle;
  }
}

/// Three pairs, unevenly spaced in time, with turns in each step; all have the same offset.
std::vector<TimedPose> unsteadyPoses(double offset) {
  const Eigen::Isometry3d first = motionFromVector(vector6(3.0, -1.0, 2.0, 0.4, 0.3, -0.2));
  const Eigen::Isometry3d second = first * motionFromVector(vector6(0.03, -0.02, 0.15, 0.02, -0.09, 0.03));
  const Eigen::Isometry3d third = second * motionFromVector(vector6(-0.04, 0.01, 0.24, -0.05, 0.11, 0.07));
  return {{0.0, offset, first}, {0.05, offset, second}, {0.12, offset, third}};
}

Matrix6d rightByPose(const std::vector<TimedPose>& poses, int index, int moved) {
  const Eigen::Isometry3d before = rightCameraOf(poses, index, kRigCamera.baseline).T_world_camera;
  return centralDifference<6>([&](const Vector6d& delta) -> Vector6d {
    std::vector<TimedPose> changed = poses;
    changed[moved].T_world_camera = changed[moved].T_world_camera * motionFromVector(delta);
    return vectorFromMotion(before.inverse() *
                            rightCameraOf(changed, index, kRigCamera.baseline).T_world_camera);
  });
}

TEST(RightCamera, DerivativesAgreeWithDifferences) {
  struct Case {
    double offset;
    int index;
    int neighbour;
    int third;
  };
  // Interpolation with a later and an earlier neighbour, extrapolation at both ends, and no offset.
  for (const Case& c : {Case{0.02, 1, 2, 0}, Case{-0.02, 1, 0, 2}, Case{0.02, 2, 1, 0}, Case{-0.02, 0, 1, 2},
                        Case{0.0, 1, -1, -1}}) {
    const std::vector<TimedPose> poses = unsteadyPoses(c.offset);
    const RightCamera right = rightCameraOf(poses, c.index, kRigCamera.baseline);
    EXPECT_EQ(right.neighbour, c.neighbour);
    EXPECT_EQ(right.third, c.third);
    for (int moved = 0; moved < 3; ++moved) {
      Matrix6d expected = Matrix6d::Zero();
      if (moved == c.index) expected = right.by_own;
      if (moved == c.neighbour) expected = right.by_neighbour;
      if (moved == c.third) expected = right.by_third;
      EXPECT_LT((rightByPose(poses, c.index, moved) - expected).norm(), 1e-7)
          << c.offset << " s, pair " << c.index << ", moved " << moved;
    }
  }
}

TEST(RightCamera, DerivativeByTheOffsetAgreesWithDifferences) {
  for (const double offset : {-0.02, 0.0, 0.02}) {
    for (int index = 0; index < 3; ++index) {
      const std::vector<TimedPose> poses = unsteadyPoses(offset);
      const RightCamera right = rightCameraOf(poses, index, kRigCamera.baseline);
      const auto expected = centralDifference<1>([&](const Eigen::Matrix<double, 1, 1>& delay) -> Vector6d {
        std::vector<TimedPose> changed = poses;
        changed[index].offset += delay[0];
        return vectorFromMotion(right.T_world_camera.inverse() *
                                rightCameraOf(changed, index, kRigCamera.baseline).T_world_camera);
      });
      EXPECT_LT((right.by_offset - expected).norm(), 1e-6) << offset << " s, pair " << index;
    }
  }
}

TEST(RightCamera, IsIndependentOfTheOffsetAtStandstill) {
  const std::vector<TimedPose> poses = {{0.0, 0.02, steadyDrive(1.0)}, {0.05, 0.02, steadyDrive(1.0)}};
  EXPECT_LT(rightCameraOf(poses, 1, kRigCamera.baseline).by_offset.norm(), 1e-12);
}

TEST(RightCamera, IsExactOnASteadyDrive) {
  for (const double offset : {-0.027, -0.01, 0.004, 0.027}) {
    const std::vector<TimedPose> poses = {{0.0, offset, steadyDrive(0.0)},
                                          {0.055, offset, steadyDrive(0.055)},
                                          {0.11, offset, steadyDrive(0.11)}};
    for (int i = 0; i < 3; ++i) {
      const Eigen::Isometry3d expected = test::rightOf(steadyDrive(poses[i].time + offset));
      const RightCamera right = rightCameraOf(poses, i, kRigCamera.baseline);
      EXPECT_LT((right.T_world_camera.matrix() - expected.matrix()).norm(), 1e-12)
          << offset << " s, pair " << i;
    }
  }
}

TEST(RightCamera, IsExactOnAnAcceleratedCurve) {
  const auto drive = [](double t) {
    return motionFromVector(vector6(2.0 * t * t, 0.0, 5.0 * t + t * t, 0.0, 0.4 * t + 0.3 * t * t, 0.0));
  };
  for (const double offset : {-0.027, 0.004, 0.027}) {
    const std::vector<TimedPose> poses = {
        {0.0, offset, drive(0.0)}, {0.055, offset, drive(0.055)}, {0.12, offset, drive(0.12)}};
    for (int i = 0; i < 3; ++i) {
      const Eigen::Isometry3d expected = test::rightOf(drive(poses[i].time + offset));
      const RightCamera right = rightCameraOf(poses, i, kRigCamera.baseline);
      EXPECT_LT((right.T_world_camera.matrix() - expected.matrix()).norm(), 1e-12)
          << offset << " s, pair " << i;
    }
  }
}

TEST(RightCamera, IsOneBaselineFromTheLeftOneAtZeroOffset) {
  const std::vector<TimedPose> poses = unsteadyPoses(0.0);
  const RightCamera right = rightCameraOf(poses, 1, kRigCamera.baseline);
  EXPECT_LT((right.T_world_camera.matrix() - test::rightOf(poses[1].T_world_camera).matrix()).norm(), 1e-12);
}

TEST(RightCamera, IsOneBaselineFromTheLeftOneForASinglePair) {
  const std::vector<TimedPose> poses = {{0.0, 0.02, steadyDrive(1.0)}};
  const RightCamera right = rightCameraOf(poses, 0, kRigCamera.baseline);
  EXPECT_EQ(right.neighbour, -1);
  EXPECT_LT((right.T_world_camera.matrix() - test::rightOf(steadyDrive(1.0)).matrix()).norm(), 1e-12);
}

}  // namespace
}  // namespace cartvo::vo
