#pragma once

#include "vo_core/rolling_shutter/row_motion.hpp"
#include "vo_core/shutter.hpp"

namespace cartvo::vo {

/// Information filter for the readout of a camera. A known readout is estimated, too, to check it, but the
/// estimate is not used.
class ReadoutFilter {
 public:
  ReadoutFilter() = default;
  explicit ReadoutFilter(const Shutter& shutter);

  /// Updates with the equation of one image, whose rows were timed with readout(). `weight`: number of images
  /// that it stands for.
  void update(const ReadoutEquation& equation, double weight);

  /// Readout (s) to time rows with: that of the shutter if it is known, else the estimate.
  double readout() const { return is_known_ ? known_ : estimate_; }
  /// Standard deviation (s) of readout(): 0 if it is known.
  double stddev() const { return is_known_ ? 0.0 : estimate().stddev; }

  /// Estimate (s) of an unknown or a known readout.
  EstimateWithStddev estimate() const;

 private:
  double known_ = 0.0;
  bool is_known_ = true;
  double estimate_ = 0.0;
  double information_ = 1.0;  ///< 1/s^2
};

/// The readouts of both cameras. That of the right one is estimated as a difference: its rows are compared
/// with a map that was made with the rows of the left one, so that an error of the left readout is shared.
class ReadoutFilters {
 public:
  ReadoutFilters() = default;
  explicit ReadoutFilters(const StereoShutters& shutters);

  void updateLeft(const ReadoutEquation& equation, double weight) { left_.update(equation, weight); }
  void updateRight(const ReadoutEquation& equation, double weight) { difference_.update(equation, weight); }

  double left() const { return left_.readout(); }
  double right() const { return is_right_known_ ? known_right_ : left() + difference_.readout(); }
  double leftStddev() const { return left_.stddev(); }
  /// s, of the right readout with a given left one; 0 if it is known.
  double rightStddev() const { return is_right_known_ ? 0.0 : difference_.stddev(); }

  ReadoutEstimates estimates() const;

 private:
  ReadoutFilter left_, difference_;
  double known_right_ = 0.0;
  bool is_right_known_ = true;
};

}  // namespace cartvo::vo
