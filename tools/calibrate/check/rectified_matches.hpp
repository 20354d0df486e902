#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace cartvo::calibrate {

/// A point in both rectified images, px.
struct RectifiedMatch {
  cv::Point2f left, right;

  double disparity() const { return left.x - right.x; }
  /// Zero, except for noise, if the rig is correct.
  double verticalDisparity() const { return left.y - right.y; }
};

/// Matches points between two rectified images (CV_8UC1) without assuming that rows correspond. ORB features
/// are matched with a mutual and a ratio test (E. Rublee et al., ICCV 2011; D. Lowe, IJCV 2004) and then
/// aligned to some hundredths of a pixel by the Lucas-Kanade method, forwards and backwards. The result may
/// contain mismatches.
std::vector<RectifiedMatch> matchRectified(const cv::Mat& left, const cv::Mat& right);

}  // namespace cartvo::calibrate
