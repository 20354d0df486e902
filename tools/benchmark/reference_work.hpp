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
  /// Two images of one camera, one after the other: CV_8UC1, of one size. Throws std::invalid_argument if the
  /// first has no thousand corners.
  ReferenceWork(cv::Mat before, cv::Mat after);

  /// Does it all once. Sets OpenCV's number of threads for that long: nothing else must use it meanwhile.
  ReferenceTimes run() const;

 private:
  cv::Mat before_, after_;
  cv::Mat map_, map_fraction_;
  std::vector<cv::Point2f> points_;
};

}  // namespace cartvo::benchmark
