#pragma once

#include <Eigen/Core>
#include <deque>

#include <opencv2/core/mat.hpp>

namespace cartvo::pipeline {

/// Takes bright and dark bands out of a camera's pictures, which lamps on the mains make with a rolling
/// shutter. They run through the picture otherwise than the scene, and differ between left and right. Not
/// thread-safe.
class LampBands {
 public:
  /// The picture (CV_8UC1) without its bands, in memory of this object until the next call; the picture
  /// itself if it has none. Bands are known from the eighth picture on, unless they stand still.
  cv::Mat without(const cv::Mat& picture);

 private:
  std::deque<Eigen::VectorXd> profiles_;  ///< logarithms of the rows' mean brightness, of the latest pictures
  cv::Mat levelled_;
};

}  // namespace cartvo::pipeline
