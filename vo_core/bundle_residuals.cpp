// Where the cameras of a bundle should see a landmark, and where they do.
#include "vo_core/bundle_residuals.hpp"

#include <cmath>

namespace cartvo {
namespace {

double robustWeight(double squared_error, double width) {
  return 1.0 / (1.0 + squared_error / (width * width));
}

}  // namespace

BundleCameras::BundleCameras(const std::vector<TimedPose>& poses, double baseline)
    : count_(static_cast<int>(poses.size())) {
  for (int i = 0; i < count_; ++i)
    right_.push_back(rightCameraOf(poses, i, baseline));
  for (int camera = 0; camera < count_; ++camera) {
    const Eigen::Isometry3d left_inverse = poses[camera].T_world_camera.inverse();
    const Eigen::Isometry3d right_inverse = right_[camera].T_world_camera.inverse();
    for (int host = 0; host < count_; ++host) {
      T_left_host_.push_back(left_inverse * poses[host].T_world_camera);
      T_right_host_.push_back(right_inverse * poses[host].T_world_camera);
    }
  }
}

bool LandmarkRows::linearise(const BundleLandmark& landmark) {
  rows_.clear();
  const int host = landmark.sightings.front().pose;
  for (std::size_t i = 0; i < landmark.sightings.size(); ++i)
    if (!addSighting(landmark, landmark.sightings[i], host, i == 0)) return false;
  return true;
}

bool LandmarkRows::addSighting(const BundleLandmark& landmark, const BundleSighting& sighting, int host,
                               bool is_host) {
  const StereoCamera& camera = problem_.camera;
  const Eigen::Isometry3d& T_left_host = cameras_.leftFromHost(sighting.pose, host);
  const Projection left = projectLandmark(camera, T_left_host, landmark.bearing, landmark.inverse_depth);
  if (!left.valid) return false;
  const ProjectionJacobians by =
      projectionJacobians(camera, T_left_host, landmark.bearing, landmark.inverse_depth, left);
  if (!is_host) {
    const double precision = 1.0 / problem_.noise.pixel;
    const Eigen::Vector2d error = precision * (sighting.left - left.pixel);
    const double weight = landmark.weight * robustWeight(0.5 * error.squaredNorm(), robust_width_);
    for (int axis = 0; axis < 2; ++axis) {
      BundleRow& row = rows_.emplace_back();
      row.residual = error[axis];
      row.weight = weight;
      row.by_inverse_depth = precision * by.by_inverse_depth[axis];
      row.add(sighting.pose, precision * by.by_camera.row(axis));
      row.add(host, precision * by.by_host.row(axis));
    }
  }
  return !sighting.stereo || addDisparity(landmark, sighting, host, is_host, left, by);
}

bool LandmarkRows::addDisparity(const BundleLandmark& landmark, const BundleSighting& sighting, int host,
                                bool is_host, const Projection& left, const ProjectionJacobians& by_left) {
  const Eigen::Isometry3d& T_right_host = cameras_.rightFromHost(sighting.pose, host);
  const Projection right =
      projectLandmark(problem_.camera, T_right_host, landmark.bearing, landmark.inverse_depth);
  if (!right.valid) return false;
  const ProjectionJacobians by =
      projectionJacobians(problem_.camera, T_right_host, landmark.bearing, landmark.inverse_depth, right);
  const RightCamera& right_camera = cameras_.right(sighting.pose);

  const double precision =
      1.0 / (problem_.noise.disparity + problem_.noise.stretch * std::abs(sighting.disparity()));
  BundleRow& row = rows_.emplace_back();
  row.residual = precision * (sighting.disparity() - (left.pixel.x() - right.pixel.x()));
  row.weight = landmark.weight * robustWeight(row.residual * row.residual, robust_width_);
  row.by_inverse_depth = precision * (by_left.by_inverse_depth.x() - by.by_inverse_depth.x());
  row.by_shared.head<RigCorrection::kSize>() =
      precision * columnByCorrection(problem_.camera, sighting.right);
  // Predicted, not measured: the noise of what is measured would take part in its own derivative, and a
  // bias come of it. Of the disparity, what the baseline makes; what the motion since the left exposure
  // makes scales with the window.
  row.by_shared[RigCorrection::kSize] = precision * problem_.camera.focal_length * problem_.camera.baseline *
                                        landmark.inverse_depth / right.ray.z();
  if (!is_host) {
    row.add(sighting.pose, precision * by_left.by_camera.row(0));
    row.add(host, precision * by_left.by_host.row(0));
  }
  const RowVector6d by_right = -precision * by.by_camera.row(0);
  row.add(sighting.pose, by_right * right_camera.by_own);
  if (right_camera.neighbour >= 0) row.add(right_camera.neighbour, by_right * right_camera.by_neighbour);
  if (right_camera.third >= 0) row.add(right_camera.third, by_right * right_camera.by_third);
  row.add(host, -precision * by.by_host.row(0));
  row.by_late_right = by_right.dot(right_camera.by_offset.transpose());
  return true;
}

}  // namespace cartvo
