#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace cartvo::benchmark {

/// What OpenCV takes for a pair on one thread, ms.
struct ReferenceTimes {
  double remap = 0.0;     ///< both images through fixed-point maps (CV_16SC2), bilinear
  double pyramids = 0.0;  ///< cv::buildOpticalFlowPyramid of both, four levels
  double klt = 0.0;  ///< cv::calcOpticalFlowPyrLK, 1,000 points, 21x21, four levels, 30 iterations or 0.01 px

  double all() const { return remap + pyramids + klt; }
};

/// Work that never changes, of a library that everybody has: divided by its time, a time means the same on a
/// fast machine and on a busy one.
class ReferenceWork {
 public:
  /// Images of one camera, one after the other: CV_8UC1, of one size. The work is done on each step from one
  /// to the next, or on some from all over them: how far the KLT has to go differs from step to step by a
  /// half (kitti_06: 12 to 19 ms), and the mean of a few says little. Steps from an image without a thousand
  /// corners are left out. Throws std::invalid_argument if there are not two, or if all are.
  explicit ReferenceWork(const std::vector<cv::Mat>& images);

  /// Does it all once: the mean of the steps. Sets OpenCV's number of threads for that long: nothing else
  /// must use it meanwhile.
  ReferenceTimes run() const;
  std::size_t steps() const { return steps_.size(); }

 private:
  struct Step {
    cv::Mat before, after;
    std::vector<cv::Point2f> points;  ///< of the image before
  };
  ReferenceTimes timesOf(const Step& step) const;

  std::vector<Step> steps_;
  cv::Mat map_, map_fraction_;
};

}  // namespace cartvo::benchmark
