#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "capture/video_file_source.hpp"

namespace cartvo {

/// How the picture of one camera moved as a whole: its position over time, summed up from picture to picture.
struct ImageMotion {
  std::vector<double> times;           ///< s, increasing
  std::vector<cv::Point2d> positions;  ///< widths of the image, right and down
};

/// Sums up the shift from picture to picture, by phase correlation and least squares, at a resolution of 128
/// px, over the middle of the image, where no text is laid over it.
class ImageMotionTracker {
 public:
  /// A picture (CV_8UC1) of that time; one that is not later than the one before is left out.
  void add(double time, const cv::Mat& image);

  const ImageMotion& motion() const { return motion_; }

 private:
  cv::Mat window_;
  cv::Mat last_;
  ImageMotion motion_;
};

/// Of a whole video; `progress` is told of each picture.
ImageMotion motionOf(VideoFileSource& video, const std::function<void()>& progress);

}  // namespace cartvo
