#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "pipeline/pair_processor.hpp"

namespace cartvo {

/// Draws the pictures of a replay's video: the left picture with the landmarks, coloured by depth, and
/// their motion; the path from above; time, state, speed and rates with units.
class ReplayPictures {
 public:
  /// The picture of the next pair (CV_8UC3, BGR; even width and height). `left`: its rectified left image.
  cv::Mat draw(const pipeline::PairResult& result, const cv::Mat& left, const vo::LandmarkViews& landmarks);

 private:
  void addToPath(const pipeline::PairResult& result);
  void extendPath(const cv::Point2d& place);

  std::int64_t first_ns_ = 0;
  bool has_first_ = false;
  std::uint32_t epoch_ = 0;
  Eigen::Isometry3d T_first_epoch_ = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d T_first_body_ = Eigen::Isometry3d::Identity();
  double distance_ = 0.0;  ///< m, along the path
  std::vector<cv::Point2d>
      path_;                    ///< x: to the right, y: forward, m, at the first pair; ends at the last pair
  double path_spacing_ = 0.05;  ///< m, of its points
};

}  // namespace cartvo
