#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace cartvo::calibrate {

constexpr double kMinDisparity = -1.0;  ///< px: smaller ones are clearly negative

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

/// Whether the raw pictures of a pair are of one camera, also if they were encoded apart: they differ by less
/// than by a shift of one pixel. Never for pictures without texture.
bool areOfOneCamera(const cv::Mat& left, const cv::Mat& right);

/// Numbers of the matches that contradict a rig.
struct Contradictions {
  int all = 0;
  int repeated =
      0;  ///< of these, with a second place in the right image that fits as well and agrees with it

  /// Whether the scene repeats itself, as a board does, so that matches may be shifted.
  bool areOfARepeatedPattern() const { return all > 0 && 2 * repeated > all; }
};

/// Adds the contradictions among a sample of the matches of two rectified images: rows that differ by more
/// than `max_difference` px, or negative disparities.
void addContradictions(const cv::Mat& left, const cv::Mat& right, const std::vector<RectifiedMatch>& matches,
                       double max_difference, Contradictions& contradictions);

}  // namespace cartvo::calibrate
