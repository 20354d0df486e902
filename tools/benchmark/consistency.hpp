#pragma once

#include <cstddef>
#include <vector>

#include "vo_core/rigid_motion.hpp"

namespace cartvo::benchmark {

struct Interval {
  double low = 0.0;
  double high = 0.0;

  bool holds(double value) const { return low <= value && value <= high; }
};

/// The central 95 % of the means of `count` independent values of chi-square(6) / 6: where the normalised
/// error (below) of an estimator lies that knows its uncertainty. `count` must be positive.
Interval consistencyBand(std::size_t count);

/// Whether errors are as large as their covariances say: the normalised estimation error squared (NEES,
/// Y. Bar-Shalom, X. R. Li, T. Kirubarajan, "Estimation with Applications to Tracking and Navigation", 2001,
/// 5.4.2) over its dimension, e' P^-1 e / 6. Its mean is 1 where the covariance is right, larger where it
/// promises too much, smaller where it promises too little.
///
/// Errors come in groups of which each counts as one independent sample, however many errors are in it: the
/// motions are groups of their own; all poses of an epoch are one, because each holds the errors of those
/// before. The mean is that of the groups' means.
class NormalisedErrors {
 public:
  void beginGroup() { group_open_ = false; }

  /// An error of the group begun last, and its covariance, both in one order, unit and frame. One that is not
  /// positive definite says nothing and is counted as unusable.
  void add(const Vector6d& error, const Matrix6d& covariance);

  /// The groups of `other` as well.
  void add(const NormalisedErrors& other);

  std::size_t groups() const { return groups_.size(); }
  std::size_t unusable() const { return unusable_; }

  /// There must be a group.
  double mean() const;
  Interval band() const { return consistencyBand(groups()); }

 private:
  struct Group {
    double sum = 0.0;
    std::size_t count = 0;
  };
  std::vector<Group> groups_;
  bool group_open_ = false;
  std::size_t unusable_ = 0;
};

}  // namespace cartvo::benchmark
