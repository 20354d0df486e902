#include "calib/corner_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace cartvo {

std::optional<Eigen::Vector2d> refinedCorner(const cv::Mat& grey, const Eigen::Vector2d& start, double room) {
  constexpr int kSmallestReach = 2, kLargestReach = 11;
  const int reach = std::clamp(static_cast<int>(std::floor(room)) - 1, kSmallestReach, kLargestReach);
  const double margin = reach + 2.0;
  if (!(start.x() >= margin && start.y() >= margin && start.x() <= grey.cols - 1 - margin &&
        start.y() <= grey.rows - 1 - margin)) {
    return std::nullopt;
  }
  std::vector<cv::Point2f> corner{{static_cast<float>(start.x()), static_cast<float>(start.y())}};
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-3);
  cv::cornerSubPix(grey, corner, {reach, reach}, {-1, -1}, until);
  const Eigen::Vector2d refined(corner[0].x, corner[0].y);
  // Where there is nothing to hold it the iteration drifts away, or gives the start back unchanged.
  if (!refined.allFinite() || (refined - start).norm() >= reach) return std::nullopt;
  return refined;
}

}  // namespace cartvo
