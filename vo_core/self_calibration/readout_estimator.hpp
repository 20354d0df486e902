#pragma once

#include "vo_core/rig_calibration_error.hpp"
#include "vo_core/rolling_shutter/row_motion.hpp"
#include "vo_core/self_calibration_settings.hpp"
#include "vo_core/shutter.hpp"

// A readout that is not stated.

namespace cartvo::vo {

/// Estimates the readout of a camera (s) by a Kalman filter on how much the images differ from the readout
/// that their rows are timed with. As long as the estimate is uncertain it is considered in the motions'
/// covariances (S. Schmidt, "Application of state-space methods to navigation problems", 1966), and the rows
/// tell no motion: otherwise the readout would be measured by motions that it has itself shaped.
///
/// Images that share errors of poses count as one; images that scatter more than stated count less.
class ReadoutEstimator {
 public:
  /// A known readout (`shutter.readout_stddev` is 0) is measured to check it, and stays.
  ReadoutEstimator(const Shutter& shutter, const SelfCalibrationSettings& settings);

  /// Adds the equation of an image whose rows were timed with used().
  void update(const ReadoutEquation& equation);

  /// Replaces the estimate (s) of a readout that is not known by that of another estimator.
  void set(const EstimateWithStddev& estimate);

  double used() const { return used_; }  ///< s, to time rows with; 0: a global shutter
  double stddev() const;                 ///< s, of used(); 0 if known
  /// Whether used() may be far off: the images have not shown it yet.
  bool isUnknown() const { return !known_ && estimate().stddev > 3.0 * model_stddev_; }
  /// Whether the error of used() matters beside that which no number of images reduces.
  bool isUncertain() const { return stddev() > 1.25 * model_stddev_; }
  /// Readout that the images show, s; of a known readout, too.
  EstimateWithStddev estimate() const;

 private:
  friend struct ReadoutEstimators;
  void addImage(double measured, double variance);
  /// Times rows with the estimate (s), within the readouts of cameras; with none if it is shown that it is
  /// short.
  void use(double estimate, bool is_shown);

  bool known_;
  double model_stddev_;  ///< s, error of an estimate that no number of images reduces
  double innovation_limit_;
  double prior_variance_;  ///< s^2
  double used_, estimate_;
  double variance_;       ///< s^2, of estimate_, without the model's
  double scatter_ = 1.0;  ///< mean square of the innovations relative to their variances
};

/// Of both cameras.
struct ReadoutEstimators {
  ReadoutEstimator left, right;

  ReadoutEstimators(const StereoShutters& shutters, const SelfCalibrationSettings& settings)
      : left(shutters.left, settings), right(shutters.right, settings) {}

  /// Times rows with the newest estimates. Unknown readouts that do not differ significantly count as one: a
  /// difference between the cameras would change all disparities. Returns whether used() of a camera has
  /// changed.
  bool choose();
  bool areUnknown() const { return left.isUnknown() || right.isUnknown(); }
  bool areUncertain() const { return left.isUncertain() || right.isUncertain(); }
  ReadoutEstimates estimates() const { return {left.estimate(), right.estimate()}; }
};

}  // namespace cartvo::vo
