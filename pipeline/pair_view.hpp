#pragma once

#include <opencv2/core/mat.hpp>

#include "pipeline/stage_clock.hpp"
#include "vo_core/image_region.hpp"
#include "vo_core/landmark_view.hpp"

// A processed pair for a display.

namespace cartvo::pipeline {

/// Copies of the rectified pictures (CV_8UC1), and what the odometry found in them.
struct PairView {
  cv::Mat left, right;
  vo::LandmarkViews landmarks;
  vo::ImageRegions still_regions;  ///< of the left picture: parts in which the view stands still
  StageTimes times;
};

/// Asks for the pictures of pairs. Called by the thread that processes them: must not wait.
class PairViewer {
 public:
  virtual ~PairViewer() = default;

  /// Called before each pair: where to copy it, until the next call; nullptr: the pair is not wanted.
  virtual PairView* nextView() = 0;
};

}  // namespace cartvo::pipeline
