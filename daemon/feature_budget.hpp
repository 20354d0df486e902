#pragma once

namespace cartvo {

/// How many features the odometry may look for so that each pair is done before the next one comes. When the
/// computer cannot keep up, fewer features, found in time, are worth more than all of them late: time grows
/// with the features, accuracy hardly (docs/method.md, half-features).
///
/// The number falls at once to what the time for the last pairs calls for, and comes back slowly. Pure.
class FeatureBudget {
 public:
  /// `most`: features as configured. `period`: s between pairs.
  FeatureBudget(int most, double period);

  /// A pair took `seconds`. Returns the features to aim at from now on.
  int next(double seconds);

 private:
  int most_;
  double period_;
  double features_;
  double last_load_ = 0.0;  ///< of the pair before, in periods
};

}  // namespace cartvo
