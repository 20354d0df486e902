#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/association.hpp"

namespace cartvo {

/// KITTI's segments (A. Geiger et al., "Are we ready for autonomous driving?", 2012, and its devkit), and
/// shorter ones for sequences that are too short for them, m.
inline constexpr std::array<double, 8> kLongSegments{100, 200, 300, 400, 500, 600, 700, 800};
inline constexpr std::array<double, 4> kShortSegments{5, 10, 20, 40};

/// Mean errors over segments: error of the motion between two poses whose true distance along the path is the
/// segment's length, divided by that length.
struct SegmentErrors {
  double length = 0.0;  ///< m; 0: all lengths together
  int count = 0;
  double translation = 0.0;  ///< a fraction of the length
  double rotation = 0.0;     ///< rad/m
};

struct SegmentGroup {
  SegmentErrors all;                ///< mean over all segments of all lengths, as in the devkit
  std::vector<SegmentErrors> each;  ///< one per length; lengths without a segment are omitted
};

/// Errors after rotation of the estimate's axes into the truth's (axesRotation()).
struct AlignedAxes {
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< rotation vector, estimate's to truth's axes, rad
  SegmentGroup short_segments;
};

struct Evaluation {
  AssociationMethod method = AssociationMethod::rows;
  std::size_t poses = 0;      ///< compared
  std::size_t unmatched = 0;  ///< poses of the estimate without a truth

  double path_length = 0.0;            ///< of the truth, m
  double estimated_path_length = 0.0;  ///< m

  double final_drift = 0.0;                    ///< distance between the two ends if the starts coincide, m
  std::optional<double> final_drift_fraction;  ///< of the path length; empty if that is shorter than 1 m
  double final_rotation = 0.0;                 ///< angle between the two ends, rad

  double absolute_aligned = 0.0;  ///< RMSE of position after the best rigid alignment (ATE), m
  double absolute_origin = 0.0;   ///< RMSE of position if the starts coincide, or as placed by --align, m

  double relative_translation = 0.0;  ///< RMSE of the motion from pose to pose (RPE), m
  double relative_rotation = 0.0;     ///< rad

  SegmentGroup short_segments;  ///< 5 to 40 m, one starting at each pose
  SegmentGroup long_segments;   ///< 100 to 800 m, one starting at each tenth pose, as in the devkit
  std::optional<AlignedAxes> aligned_axes;  ///< empty without a short segment
  std::optional<double> scale;              ///< by which the estimate's path was corrected
  std::vector<std::string> problems;        ///< why the comparison may be meaningless, with the remedies
};

/// Computes all error measures.
Evaluation evaluate(const AssociatedTrajectories& associated);

/// Errors of short segments after the best rotation of the axes; empty without a segment.
std::optional<AlignedAxes> alignedAxes(const AssociatedTrajectories& associated);

/// Distance along the path from its start to each pose, m.
std::vector<double> distancesAlong(const Trajectory& trajectory);

/// Transforms a trajectory so that its first pose is `start`.
Trajectory startingAt(const Eigen::Isometry3d& start, const Trajectory& trajectory);

}  // namespace cartvo
