#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "capture/dataset/video_file_source.hpp"

namespace cartvo {

/// Global image motion of one camera: position over time, accumulated from picture to picture.
struct ImageMotion {
  std::vector<double> times;           ///< s, increasing
  std::vector<cv::Point2d> positions;  ///< right and down, in widths of the cropped image
};

/// Accumulates the shift from picture to picture, by phase correlation and least squares, at a width of 128
/// px. Uses the middle of the image, which has no text overlay.
class ImageMotionTracker {
 public:
  /// Adds a picture (CV_8UC1) at `time`, s. A picture that is not later than the previous one is ignored.
  void addImage(double time, const cv::Mat& image);

  const ImageMotion& motion() const { return motion_; }

 private:
  cv::Mat window_;
  cv::Mat last_;
  ImageMotion motion_;
};

/// Measures the image motion of a whole video; calls `progress` after each picture.
ImageMotion measureImageMotion(capture::VideoFileSource& video, const std::function<void()>& progress);

}  // namespace cartvo
