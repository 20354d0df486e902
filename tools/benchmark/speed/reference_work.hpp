#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace cartvo::benchmark {

/// Times of OpenCV for one pair on one thread, ms.
struct ReferenceTimes {
  double remap = 0.0;     ///< both images through fixed-point maps (CV_16SC2), bilinear
  double pyramids = 0.0;  ///< cv::buildOpticalFlowPyramid of both, four levels
  double klt = 0.0;  ///< cv::calcOpticalFlowPyrLK, 1,000 points, 21x21, four levels, 30 iterations or 0.01 px

  double all() const { return remap + pyramids + klt; }
};

/// Fixed work of a common library as a unit of time: ratios to it are comparable between fast, slow and busy
/// machines.
class ReferenceWork {
 public:
  /// `images`: consecutive images of one camera, CV_8UC1, all of one size. The work is done on each step from
  /// one image to the next, or on 50 evenly spaced steps of a longer sequence: the time of the KLT differs by
  /// a half between steps (kitti_06: 12 to 19 ms), so the mean of a few is not meaningful. Steps from an
  /// image with fewer than 1,000 corners are left out. Throws std::invalid_argument if there are fewer than
  /// two images or no steps.
  explicit ReferenceWork(const std::vector<cv::Mat>& images);

  /// Runs all steps once and returns their mean. Limits OpenCV to one thread meanwhile, so nothing else may
  /// use OpenCV at the same time.
  ReferenceTimes run() const;
  std::size_t steps() const { return steps_.size(); }

 private:
  struct Step {
    cv::Mat before, after;
    std::vector<cv::Point2f> points;  ///< corners of `before`
  };
  ReferenceTimes timesOf(const Step& step) const;

  std::vector<Step> steps_;
  cv::Mat map_, map_fraction_;
};

}  // namespace cartvo::benchmark
