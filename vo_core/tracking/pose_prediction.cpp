// Comparison of a predicted pose with landmarks and with the shift of the whole image.
#include "vo_core/tracking/pose_prediction.hpp"

#include <algorithm>

#include "common/statistics.hpp"
#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/image/image_shift.hpp"

namespace cartvo::vo {

std::optional<PixelDifference> differenceFromPrediction(std::span<const Landmark> landmarks,
                                                        std::span<const SearchResult> used,
                                                        const std::vector<WindowFrame>& window,
                                                        const StereoCamera& camera,
                                                        const Eigen::Isometry3d& T_world_camera) {
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  FixedVector<Eigen::Isometry3d, kMaximumWindowPairs> T_camera_frame;
  for (const WindowFrame& frame : window)
    T_camera_frame.push_back(T_camera_world * frame.T_world_camera);
  std::vector<double> columns, rows, sizes;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& landmark = landmarks[i];
    if (!landmark.hasDepth() || (!used.empty() && used[i] == SearchResult::lost)) continue;
    const std::optional<int> anchor = findFrameIndex(window, landmark.anchor().frame);
    if (!anchor) continue;
    const Projection predicted =
        projectLandmark(camera, T_camera_frame[static_cast<std::size_t>(*anchor)],
                        bearingOf(camera, landmark.anchor().leftAtExposure()), landmark.inverse_depth);
    if (!predicted.valid) continue;
    const Eigen::Vector2d difference = landmark.last().leftAtExposure() - predicted.pixel;
    columns.push_back(difference.x());
    rows.push_back(difference.y());
    sizes.push_back(difference.norm());
  }
  if (sizes.empty()) return std::nullopt;
  return PixelDifference{{median(columns), median(rows)}, median(sizes), sizes.size()};
}

namespace {

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

std::optional<Eigen::Isometry3d> correctedByLandmarks(std::span<const Landmark> landmarks,
                                                      std::span<const SearchResult> used,
                                                      const std::vector<WindowFrame>& window,
                                                      const StereoCamera& camera,
                                                      const Eigen::Isometry3d& T_world_camera,
                                                      const OdometrySettings& settings) {
  const auto error = differenceFromPrediction(landmarks, used, window, camera, T_world_camera);
  if (!error || static_cast<int>(error->landmarks) < settings.validity.minimum_inliers) return std::nullopt;
  const Eigen::Isometry3d corrected = rotated(T_world_camera, error->median, camera);
  const auto left = differenceFromPrediction(landmarks, used, window, camera, corrected);
  return left && left->size < settings.tracking.maximum_prediction_error ? std::optional(corrected)
                                                                         : std::nullopt;
}

std::optional<Eigen::Isometry3d> correctedByImageShift(std::span<const Landmark> landmarks,
                                                       const std::vector<WindowFrame>& window,
                                                       const ImagePyramid& left, const StereoCamera& camera,
                                                       const Eigen::Isometry3d& T_world_camera) {
  const ImagePyramid& last = *window.back().left;
  const auto shift = findImageShift(last, left);
  if (!shift) return std::nullopt;
  const auto predicted = differenceFromPrediction(landmarks, {}, window, camera, T_world_camera);
  // The landmarks' positions are those of the last pair: their difference is minus the predicted shift.
  const Eigen::Vector2d missing = *shift + (predicted ? predicted->median : Eigen::Vector2d::Zero());
  const double pixel = levelScale(static_cast<int>(std::min(last.grey.size(), left.grey.size())) - 1);
  if (missing.norm() < pixel) return std::nullopt;
  return rotated(T_world_camera, missing, camera);
}

}  // namespace cartvo::vo
