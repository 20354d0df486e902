#pragma once

#include "vo_core/odometry_settings.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::vo {

/// Error of a motion between two pairs, split by cause: the uncertainty model of OdometryEstimate
/// (docs/how-it-works.md, section 8). Perturbations on the right, in the order (x, y, z, rotation); m and
/// rad.
struct MotionError {
  Matrix6d by_landmarks = Matrix6d::Zero();  ///< noise of both poses relative to the landmarks
  /// Error of the window's scale. Fixed poses and landmark depths share that scale, so a motion that agrees
  /// with them has the same scale error.
  Matrix6d by_scale = Matrix6d::Zero();
  Matrix6d by_rows = Matrix6d::Zero();        ///< uncertain motion about the exposures of rolling shutters
  Matrix6d by_standstill = Matrix6d::Zero();  ///< of a zero-velocity update, or of the pose where it ended
  Matrix6d by_codec_shift =
      Matrix6d::Zero();                    ///< of the shifts of key frames that were removed from the motion
  Vector6d by_offset = Vector6d::Zero();   ///< error for one stddev of the time offset
  Vector6d by_readout = Vector6d::Zero();  ///< error for one stddev of the readouts, while they are unknown
  double startup_inflation = 1.0;          ///< see startupInflation()
  double codec_inflation =
      1.0;  ///< of measurements in inter-coded pictures: CodecErrorModel::poseNoiseInflation()

  Matrix6d offsetCovariance() const { return by_offset * by_offset.transpose(); }
  Matrix6d readoutCovariance() const { return by_readout * by_readout.transpose(); }

  /// Covariance by the measurements. It decides whether the geometry is degenerate: an inflation makes a
  /// motion uncertain, but not degenerate.
  Matrix6d measured() const { return by_landmarks + offsetCovariance() + readoutCovariance(); }

  /// Covariance of the motion. The inflations apply to what follows from image measurements: the scale
  /// depends on disparities, which codec errors affect too.
  Matrix6d covariance() const {
    return startup_inflation * codec_inflation * (by_landmarks + by_scale + by_rows) + offsetCovariance() +
           readoutCovariance() + by_standstill + by_codec_shift;
  }
};

/// Factor on the variance of the `n`-th motion of a track while the window of `window_pairs` pairs fills: the
/// noise is still mostly an assumption, and in the dark, where few landmarks of a first pair are found again,
/// many of them agree by chance. The covariance of a pose, which exceeds the sum of those of its motions,
/// needs no factor.
inline double startupInflation(int n, int window_pairs, const UncertaintySettings& settings) {
  return n < window_pairs ? 1.0 + settings.first_motion_inflation / n : 1.0;
}

}  // namespace cartvo::vo
