#pragma once

#include <cstdint>
#include <optional>

#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// True poses at any time: translation linearly and rotation by slerp between neighbours at most 0.25 s or
/// three of the truth's median periods apart, whichever is longer, but at most 6 s. `cartvo evaluate` has the
/// same in tools/evaluate/evaluation/interpolation.py.
class InterpolatedTruth {
 public:
  /// `truth` must be sorted by time, not be empty, and outlive this object.
  explicit InterpolatedTruth(const Trajectory& truth);

  /// Pose at a time (ns); empty outside the truth (by more than 1 ms) and in wider gaps.
  std::optional<Eigen::Isometry3d> at(std::int64_t time_ns) const;

 private:
  const Trajectory& truth_;
  std::int64_t max_gap_ns_ = 0;
};

}  // namespace cartvo
