#pragma once

#include <vector>

#include "calib/board/view_coverage.hpp"
#include "calib/model/rig.hpp"

// Comparison of two calibrations of the same rig.

namespace cartvo::calib {

/// Difference in depth between two calibrations at one distance. Infinite if no point at this distance is
/// visible in covered cells of both images.
struct DepthDifference {
  double distance = 0.0;  ///< m
  double median = 0.0;    ///< of the difference over the image, m
  double p95 = 0.0;       ///< 95th percentile, m
};

/// Difference between two calibrations of the same rig. Infinite if there is no place to compare them.
struct CalibrationDifference {
  double projection_rms = 0.0;  ///< over both images, after rotating the cameras for the best agreement, px
  double projection_p95 = 0.0;  ///< 95th percentile, px
  double baseline = 0.0;        ///< relative difference of the baselines
  std::vector<DepthDifference> depth;
};

/// Compares two calibrations on a grid of the images, in covered cells and up to 60 degrees from the axis.
/// Projection: the distance between the pixels of the same ray, after the rotation of the camera that a
/// calibration cannot determine (as in mrcal; D. Kogan, "Improved camera calibration with mrcal"). Depth:
/// that which `b` triangulates for points that `a` puts at these distances (m) from the left camera.
CalibrationDifference compareCalibrations(const Rig& a, const Rig& b, const ImageCoverage& left,
                                          const ImageCoverage& right, const std::vector<double>& distances);

}  // namespace cartvo::calib
