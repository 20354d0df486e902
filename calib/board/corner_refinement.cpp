// Subpixel refinement of board corners.
#include "calib/board/corner_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace cartvo::calib {

std::optional<Eigen::Vector2d> refineCorner(const cv::Mat& grey, const Eigen::Vector2d& start, double room) {
  constexpr int kMinReach = 2, kMaxReach = 11;
  const int reach = std::clamp(static_cast<int>(std::floor(room)) - 1, kMinReach, kMaxReach);
  const double margin = reach + 2.0;
  if (!(start.x() >= margin && start.y() >= margin && start.x() <= grey.cols - 1 - margin &&
        start.y() <= grey.rows - 1 - margin)) {
    return std::nullopt;
  }
  std::vector<cv::Point2f> corner{{static_cast<float>(start.x()), static_cast<float>(start.y())}};
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 50, 1e-3);
  cv::cornerSubPix(grey, corner, {reach, reach}, {-1, -1}, until);
  const Eigen::Vector2d refined(corner[0].x, corner[0].y);
  // Without a corner the iteration drifts away or returns the start unchanged.
  if (!refined.allFinite() || (refined - start).norm() >= reach) return std::nullopt;
  return refined;
}

}  // namespace cartvo::calib
