#pragma once

#include <array>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/geometry/rig_correction.hpp"
#include "vo_core/rig_calibration_error.hpp"
#include "vo_core/self_calibration/row_measurement.hpp"
#include "vo_core/self_calibration_settings.hpp"

namespace cartvo::vo {

/// Errors of the right camera's rotation, rad.
struct RigStates {
  EstimateWithStddev pitch, yaw, roll;
};

/// Information filter for the errors of the rig's calibration while driving. Its state: pitch, roll, yaw, p2,
/// delay, and the other errors that RowPatterns names. Rows of stereo matches measure all of them, of yaw and
/// p2 only a sum; disparities measure yaw and p2. Each error does a random walk (process noise). One whose
/// innovations are larger than that allows has been bumped, and its variance grows by that of a bump.
class RigCalibrationFilter {
 public:
  explicit RigCalibrationFilter(const SelfCalibrationSettings& settings = {});

  /// Adds the process noise of `time_step` (s).
  void predict(double time_step);

  /// Updates with the rows of a pair, measured about expectedRows().
  void updateRows(const RowMeasurement& rows);

  /// Updates with the disparities of an adjusted problem, whose right pixels were corrected by `applied`.
  void updateDisparities(const BundleProblem& adjusted, const BundleResult& result,
                         const RigCorrection& applied);

  /// Sets the pitch (rad) that was found after a bump, without correlations. Roll and yaw get the variance of
  /// a bump.
  void reinitialisePitch(const EstimateWithStddev& pitch);

  /// Sets the states that another estimate has found, without correlations; a yaw only if it is measured.
  void set(const RigStates& states);
  /// Estimates with their deviations, without what the lenses leave.
  RigStates states() const;

  /// Row patterns that the state lets expect in rows that were corrected by `applied`.
  RowPatterns::Vector expectedRows(const RigCorrection& applied) const;

  /// Rotation of the right camera for the search for matches: the estimate, limited. Without p2.
  RigCorrection expected() const;

  /// Rotation and p2 to correct: significant errors, limited.
  RigCorrection correction() const;

  RigCalibrationError error() const;

 private:
  // The first components are those of RowPatterns, with kSkew in the place of the cross term, which is
  // yaw + 2 p2 + skew.
  enum Index { kSkew = RowPatterns::kCrossTerm, kYaw = RowPatterns::kSize, kP2, kSize };
  static constexpr std::array<int, 3> kAngles{RowPatterns::kPitch, kYaw, RowPatterns::kRoll};
  using Vector = Eigen::Matrix<double, kSize, 1>;
  using Matrix = Eigen::Matrix<double, kSize, kSize>;

  /// Normal equations of a measurement about the estimate.
  struct Equations {
    Matrix information = Matrix::Zero();
    Vector gradient = Vector::Zero();
    double pattern_variance = 0.0;  ///< of the error of the model, in units of the noise's
  };

  void update(const Equations& equations);
  void bump(int index);
  /// Sets one state without correlations.
  void setState(int index, const EstimateWithStddev& state);
  Equations equationsOf(const RowMeasurement& rows) const;
  RowPatterns::Vector patternVariances() const;
  RigCorrection limited(RigCorrection correction) const;

  SelfCalibrationSettings settings_;
  Vector estimate_ = Vector::Zero();
  Vector prior_variances_;
  Matrix covariance_;
  Vector mean_innovation_ = Vector::Zero();  ///< running mean of innovations in standard deviations
  RowPatterns::Matrix mean_products_ = RowPatterns::Matrix::Zero();  ///< running mean of RowMeasurement's
  double pairs_ = 0.0;                                               ///< in that mean
};

}  // namespace cartvo::vo
