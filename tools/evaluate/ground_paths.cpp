// Projects an estimate and its truth on the ground plane.
#include "tools/evaluate/ground_paths.hpp"

#include <algorithm>

#include "tools/evaluate/evaluation.hpp"

namespace cartvo {

GroundPaths groundPaths(const AssociatedTrajectories& associated, TopView view) {
  const Eigen::Isometry3d origin = associated.truth.front().pose.inverse();
  const bool is_camera = view == TopView::camera_axes;
  const auto forward_and_left = [&](const StampedPose& stamped) {
    const Eigen::Vector3d position = origin * stamped.pose.translation();
    return is_camera ? cv::Point2d(position.z(), -position.x()) : cv::Point2d(position.x(), position.y());
  };
  GroundPaths paths;
  for (const StampedPose& stamped : associated.truth)
    paths.truth.push_back(forward_and_left(stamped));
  for (const StampedPose& stamped : startingAt(associated.truth.front().pose, associated.estimate)) {
    paths.estimate.push_back(forward_and_left(stamped));
  }
  cv::Point2d low = paths.truth.front(), high = low;
  for (const cv::Point2d& point : paths.truth) {
    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
  }
  paths.horizontal = "forward (m)";
  paths.vertical = "left (m)";
  if (high.x - low.x < high.y - low.y) {
    for (std::vector<cv::Point2d>* points : {&paths.truth, &paths.estimate}) {
      for (cv::Point2d& point : *points)
        point = {-point.y, point.x};
    }
    paths.horizontal = "right (m)";
    paths.vertical = "forward (m)";
  }
  return paths;
}

}  // namespace cartvo
