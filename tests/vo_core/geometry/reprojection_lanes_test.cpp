// Tests of the SIMD projections against those of single landmarks.
#include "vo_core/geometry/reprojection_lanes.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/landmark_scene.hpp"

namespace cartvo::vo {
namespace {

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
