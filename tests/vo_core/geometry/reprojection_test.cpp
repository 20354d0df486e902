// Tests of projections; derivatives are compared with central differences.
#include "vo_core/geometry/reprojection.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"
#include "vo_core/geometry/reprojection_lanes.hpp"

namespace cartvo::vo {
namespace {

using test::kRigCamera;
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
      projectionJacobians(kRigCamera, view.fromAnchor(), view.inverse_depth, view.projection());
  const auto pixel = [&](const auto& change, const auto& delta) {
    View changed = view;
    change(changed, delta);
    return changed.projection().pixel;
  };
  const auto by_camera = centralDifference<6>([&](const Vector6d& v) -> Eigen::Vector2d {
    return pixel(
        [](View& to, const Vector6d& d) { to.T_world_camera = to.T_world_camera * motionFromVector(d); }, v);
  });
  const auto by_depth = centralDifference<1>([&](const Eigen::Matrix<double, 1, 1>& v) -> Eigen::Vector2d {
    return pixel([](View& to, const auto& d) { to.inverse_depth += d[0]; }, v);
  });
  EXPECT_LT((by.by_camera - by_camera).norm(), 1e-4);  // of some 500 px per rad
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

using test::kRigCamera;
using test::vector6;

constexpr double kClose = 1e-9;  // of some 500 px, and px per rad or m

const Eigen::Isometry3d T_camera_anchor = motionFromVector(vector6(0.4, -0.2, -0.9, 0.08, -0.2, 0.05));

struct Place {
  Eigen::Vector3d bearing;
  double inverse_depth;
};

/// Near and far places, one at infinity, one behind the camera.
std::vector<Place> places() {
  std::vector<Place> all;
  for (int i = 0; i < kDoubleLanes; ++i)
    all.push_back({Eigen::Vector3d(-0.7 + 0.4 * i, 0.4 - 0.25 * i, 1.0), 0.3 * i});
  all.back().inverse_depth = 2.0;
  return all;
}

PlaceLanes lanesOf(const std::vector<Place>& places) {
  PlaceLanes lanes{};
  for (int lane = 0; lane < kDoubleLanes; ++lane) {
    for (int axis = 0; axis < 3; ++axis)
      lanes.bearing[axis][lane] = places[lane].bearing[axis];
    lanes.inverse_depth[lane] = places[lane].inverse_depth;
  }
  return lanes;
}

void expectDerivative(const PoseLanes& lanes, int lane, const Eigen::Matrix<double, 1, 6>& expected) {
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(kRigCamera.focal_length * lanes.value[i][lane], expected[i], kClose) << lane << ", " << i;
}

TEST(ReprojectionLanes, ViewsAgreeWithProjections) {
  const std::vector<Place> known = places();
  const PlaceLanes lanes = lanesOf(known);
  const RayLanes ray = rayOf(T_camera_anchor, lanes);
  const ViewLanes view = viewOf(ray);
  for (int lane = 0; lane + 1 < kDoubleLanes; ++lane) {
    const auto& [bearing, inverse_depth] = known[lane];
    const Projection seen = projectLandmark(kRigCamera, T_camera_anchor, bearing, inverse_depth);
    ASSERT_TRUE(seen.valid);
    EXPECT_NEAR(kRigCamera.cx + kRigCamera.focal_length * view.x[lane], seen.pixel.x(), kClose);
    EXPECT_NEAR(kRigCamera.cy + kRigCamera.focal_length * view.y[lane], seen.pixel.y(), kClose);
    EXPECT_NEAR(ray.z[lane], seen.ray.z(), kClose);
  }
  const Place& behind = known.back();
  EXPECT_FALSE(projectLandmark(kRigCamera, T_camera_anchor, behind.bearing, behind.inverse_depth).valid);
  EXPECT_LT(ray.z[kDoubleLanes - 1], kNearestRay);
  EXPECT_TRUE(std::isfinite(view.x[kDoubleLanes - 1]) && std::isfinite(view.y[kDoubleLanes - 1]));
}

TEST(ReprojectionLanes, DerivativesAgreeWithProjections) {
  const std::vector<Place> known = places();
  const PlaceLanes lanes = lanesOf(known);
  const ViewLanes view = viewOf(rayOf(T_camera_anchor, lanes));
  const PoseLanes column_by_camera = columnByCamera(view, lanes), row_by_camera = rowByCamera(view, lanes);
  const PixelLanes by_depth = viewByInverseDepth(T_camera_anchor, view);
  for (int lane = 0; lane + 1 < kDoubleLanes; ++lane) {
    const auto& [bearing, inverse_depth] = known[lane];
    const Projection seen = projectLandmark(kRigCamera, T_camera_anchor, bearing, inverse_depth);
    const ProjectionJacobians by = projectionJacobians(kRigCamera, T_camera_anchor, inverse_depth, seen);
    expectDerivative(column_by_camera, lane, by.by_camera.row(0));
    expectDerivative(row_by_camera, lane, by.by_camera.row(1));
    EXPECT_NEAR(kRigCamera.focal_length * by_depth.x[lane], by.by_inverse_depth.x(), kClose);
    EXPECT_NEAR(kRigCamera.focal_length * by_depth.y[lane], by.by_inverse_depth.y(), kClose);
  }
}

}  // namespace

}  // namespace cartvo::vo
