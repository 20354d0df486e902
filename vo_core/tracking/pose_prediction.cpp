// Comparison of a predicted pose with the shift of the whole image.
#include "vo_core/tracking/pose_prediction.hpp"

#include <algorithm>

#include "common/statistics.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/image/image_shift.hpp"

namespace cartvo::vo {

namespace {

/// Median difference (px) of the landmarks' last positions from those predicted at the pose; zero if no
/// landmark has a depth.
Eigen::Vector2d differenceFromPrediction(std::span<const Landmark> landmarks,
                                         const std::vector<WindowFrame>& window, const StereoCamera& camera,
                                         const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  FixedVector<Eigen::Isometry3d, kMaximumWindowPairs> T_camera_frame;
  for (const WindowFrame& frame : window)
    T_camera_frame.push_back(T_camera_world * frame.T_world_camera);
  std::vector<double> columns, rows;
  for (const Landmark& landmark : landmarks) {
    if (!landmark.hasDepth()) continue;
    const std::optional<int> anchor = findFrameIndex(window, landmark.anchor().frame);
    if (!anchor) continue;
    const Projection predicted =
        projectLandmark(camera, T_camera_frame[static_cast<std::size_t>(*anchor)],
                        bearingOf(camera, landmark.anchor().leftAtExposure()), landmark.inverse_depth);
    if (!predicted.valid) continue;
    const Eigen::Vector2d difference = landmark.last().leftAtExposure() - predicted.pixel;
    columns.push_back(difference.x());
    rows.push_back(difference.y());
  }
  if (columns.empty()) return Eigen::Vector2d::Zero();
  return {median(columns), median(rows)};
}

/// The pose of a camera that is rotated such that the image moves by `pixels`.
Eigen::Isometry3d rotated(const Eigen::Isometry3d& T_world_camera, const Eigen::Vector2d& pixels,
                          const StereoCamera& camera) {
  // An image that moves to the right is that of a camera that turns to the left.
  const Eigen::Vector2d angle = pixels / camera.focal_length;
  Vector6d rotation = Vector6d::Zero();
  rotation.tail<3>() << angle.y(), -angle.x(), 0.0;
  return T_world_camera * motionFromVector(rotation);
}

}  // namespace

std::optional<Eigen::Isometry3d> correctedByImageShift(std::span<const Landmark> landmarks,
                                                       const std::vector<WindowFrame>& window,
                                                       const ImagePyramid& left, const StereoCamera& camera,
                                                       const Eigen::Isometry3d& T_world_camera) {
  const ImagePyramid& last = *window.back().left;
  const auto shift = findImageShift(last, left);
  if (!shift) return std::nullopt;
  // The landmarks' positions are those of the last pair: their difference is minus the predicted shift.
  const Eigen::Vector2d missing =
      *shift + differenceFromPrediction(landmarks, window, camera, T_world_camera);
  const double pixel = levelScale(static_cast<int>(std::min(last.grey.size(), left.grey.size())) - 1);
  if (missing.norm() < pixel) return std::nullopt;
  return rotated(T_world_camera, missing, camera);
}

}  // namespace cartvo::vo
