#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace cartvo::calibrate {

/// A point as two rectified images show it, px.
struct RectifiedMatch {
  cv::Point2f left, right;

  double disparity() const { return left.x - right.x; }
  /// Zero where the rig is what the images were rectified by.
  double verticalDisparity() const { return left.y - right.y; }
};

/// Finds the same points in two rectified images (CV_8UC1), wherever they are: that rows correspond is not
/// taken for granted. ORB features that are each other's best and clearly better than their second
/// (E. Rublee et al., ICCV 2011; D. Lowe, IJCV 2004), then aligned to some hundredths of a pixel by the
/// Lucas-Kanade method, forwards and backwards. May hold mismatches.
std::vector<RectifiedMatch> matchRectified(const cv::Mat& left, const cv::Mat& right);

}  // namespace cartvo::calibrate
