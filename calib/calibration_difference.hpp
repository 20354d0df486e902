#pragma once

#include <vector>

#include "calib/rig.hpp"
#include "calib/view_coverage.hpp"

namespace cartvo {

/// What a difference of calibrations does to depth at one distance; infinite if no point at this distance is
/// seen by both cameras where there were corners.
struct DepthDifference {
  double distance = 0.0;  ///< m
  double median = 0.0;    ///< of the depth's difference over the image, m
  double p95 = 0.0;       ///< m
};

/// How two calibrations of the same rig differ where it counts; infinite if there is nowhere to compare them.
struct CalibrationDifference {
  double projection_rms = 0.0;  ///< over both images, the cameras turned for the best agreement, px
  double projection_p95 = 0.0;  ///< px
  double baseline = 0.0;        ///< of the two, as a share of one
  std::vector<DepthDifference> depth;
};

/// Over a grid of the images, where there were corners and out to 60 degrees from the axis: where one
/// calibration sees what the other sees at a pixel, after the turn of the camera that a calibration cannot
/// know (as mrcal does it; D. Kogan, "Improved camera calibration with mrcal"); and the depth that one finds
/// for points which the other puts at these distances (m) before the left camera.
CalibrationDifference compareCalibrations(const Rig& a, const Rig& b, const ImageCoverage& left,
                                          const ImageCoverage& right, const std::vector<double>& distances);

}  // namespace cartvo
