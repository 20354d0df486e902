#pragma once

#include <cstddef>
#include <vector>

#include "vo_core/rigid_motion.hpp"

namespace cartvo {

struct Interval {
  double low = 0.0;
  double high = 0.0;

  bool contains(double value) const { return low <= value && value <= high; }
};

/// The central 95 % interval of the mean of `count` independent values of chi-square(6) / 6, in which the
/// mean normalised error of a consistent estimator lies. `count` must be positive.
Interval consistencyBand(std::size_t count);

/// The consistency of errors with their covariances: the normalised estimation error squared (NEES, Y.
/// Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001,
/// 5.4.2) over its dimension, e' P^-1 e / 6. Its mean is 1 where the covariance is right, larger where it is
/// too small, smaller where it is too large.
///
/// Errors are added in groups; each group counts as one independent sample, regardless of its size. Each
/// motion is a group of its own; all poses of an epoch form one group, because each contains the errors of
/// the poses before. The mean is the mean of the group means.
class NormalisedErrors {
 public:
  void beginGroup() { group_open_ = false; }

  /// Adds an error and its covariance, in the same order, units and frame, to the current group. A covariance
  /// that is not positive definite is only counted as unusable.
  void add(const vo::Vector6d& error, const vo::Matrix6d& covariance);

  std::size_t groups() const { return groups_.size(); }
  std::size_t unusable() const { return unusable_; }

  /// Requires at least one group.
  double mean() const;
  Interval band() const { return consistencyBand(groups()); }

 private:
  struct Group {
    double sum = 0.0;  // of the normalised errors
    std::size_t count = 0;
  };

  std::vector<Group> groups_;
  bool group_open_ = false;
  std::size_t unusable_ = 0;
};

}  // namespace cartvo
