// Projects an estimate and its truth on the ground plane.
#include "tools/evaluate/ground_paths.hpp"

#include <algorithm>

#include "tools/evaluate/alignment.hpp"

namespace cartvo {

GroundPaths groundPaths(const std::vector<const AssociatedTrajectories*>& associated, TopView view) {
  const AssociatedTrajectories& longest = **std::max_element(
      associated.begin(), associated.end(),
      [](const auto* one, const auto* other) { return one->truth.size() < other->truth.size(); });
  const Eigen::Isometry3d origin = longest.truth.front().pose.inverse();
  const bool is_camera = view == TopView::camera_axes;
  const auto on_ground = [&](const Trajectory& trajectory) {
    std::vector<cv::Point2d> points;  // forward and left
    for (const StampedPose& stamped : trajectory) {
      const Eigen::Vector3d position = origin * stamped.pose.translation();
      points.push_back(is_camera ? cv::Point2d(position.z(), -position.x())
                                 : cv::Point2d(position.x(), position.y()));
    }
    return points;
  };
  GroundPaths paths{on_ground(longest.truth), {}, "forward (m)", "left (m)"};
  for (const AssociatedTrajectories* one : associated)
    paths.estimates.push_back(on_ground(placedEstimate(*one)));
  cv::Point2d low = paths.truth.front(), high = low;
  for (const cv::Point2d& point : paths.truth) {
    low = {std::min(low.x, point.x), std::min(low.y, point.y)};
    high = {std::max(high.x, point.x), std::max(high.y, point.y)};
  }
  if (high.x - low.x >= high.y - low.y) return paths;
  const auto turn = [](std::vector<cv::Point2d>& points) {
    for (cv::Point2d& point : points)
      point = {-point.y, point.x};
  };
  turn(paths.truth);
  std::for_each(paths.estimates.begin(), paths.estimates.end(), turn);
  paths.horizontal = "right (m)";
  paths.vertical = "forward (m)";
  return paths;
}

}  // namespace cartvo
