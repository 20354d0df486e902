#pragma once

namespace cartvo::pipeline {

/// Limits the number of features so that each pair is processed before the next one arrives. On an overloaded
/// computer fewer features in time are worth more than all of them late: processing time grows with their
/// number, accuracy hardly does (docs/architecture.md).
///
/// The number drops at once to what the last two processing times allow and recovers slowly. Reads no clock.
class FeatureBudget {
 public:
  /// `max_features`: the configured number.
  explicit FeatureBudget(int max_features);

  /// Updates the budget with the processing time of a pair and the time between pairs, s. Returns the target
  /// number of features from now on.
  int update(double processing_time, double period);

 private:
  int max_features_;
  double features_;
  double last_load_ = 0.0;  ///< processing time of the previous pair, in periods
};

}  // namespace cartvo::pipeline
