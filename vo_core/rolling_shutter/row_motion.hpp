#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "vo_core/estimation/bundle_adjustment.hpp"
#include "vo_core/geometry/exposure_motion.hpp"

// Motion of a camera about an exposure, estimated from the rows of its image.

namespace cartvo::vo {

/// A landmark with a depth in the image.
struct RowPoint {
  /// Ray y = R b + rho t in the camera at the first guess of its pose, and its derivative t by rho.
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ(), ray_by_inverse_depth = Eigen::Vector3d::Zero();
  Eigen::Vector3d bearing = Eigen::Vector3d::UnitZ();  ///< b, in the anchor camera, z = 1
  /// Derivative of the ray by the readout (1/s), if it follows from the rows of the same camera.
  Eigen::Vector3d ray_by_readout = Eigen::Vector3d::Zero();
  double inverse_depth = 0.0;                                ///< rho, 1/m, in the anchor camera
  double inverse_depth_information = 0.0;                    ///< m^2
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();           ///< px
  double instant = 0.0;                                      ///< s since the exposure of the middle row
  double share = 0.0;                                        ///< of the readout, see RowShares
  Eigen::Vector2d relative_noise = Eigen::Vector2d::Ones();  ///< see Observation
  double weight = 1.0;
  int level = 0;
};

/// Input of the estimation.
struct RowMotionProblem {
  StereoCamera camera;
  BundleNoises noise;
  std::vector<RowPoint> points;
  ExposureMotion expected;           ///< prior of the motion
  RowInformation::Vector variances;  ///< of its difference from the true motion
  ExposureMotion start;              ///< first guess of the motion
  double robust_width = 1.5;         ///< see BundleSettings
  double depth_scale_stddev = UncertaintySettings().scale_stddev;
  RollingShutterSettings settings;
};

/// Normal equation of one image for the change of its camera's readout from the assumed one, with all else
/// eliminated.
struct ReadoutEquation {
  double information = 0.0;  ///< 1/s^2
  double gradient = 0.0;     ///< information times change
};

/// Result of the estimation.
struct RowMotion {
  bool converged = false;
  ExposureMotion motion;
  RowInformation rows;                                                 ///< without the prior
  RowInformation::Matrix covariance = RowInformation::Matrix::Zero();  ///< of `motion`
  /// Covariance that the uncertainties of motion and depths add to that of the pose.
  Matrix6d pose_covariance_by_motion = Matrix6d::Zero();
  /// Error of `motion` for each second by which the readout is longer than assumed.
  RowInformation::Vector error_by_readout = RowInformation::Vector::Zero();
  ReadoutEquation readout;
};

class RowPoints;

/// Estimates the motion of a camera, with its pose, by Gauss-Newton steps on the residuals of all rows of its
/// image, each at its own instant, with Cauchy weights and the landmarks' inverse depths eliminated. The
/// readout is considered: it is not changed, but what the image says of it and what its error does are
/// results. Components of the motion that contradict the prior lose it (Student's t distribution), so that a
/// kerb or a shaken mount is measured by the rows alone. The other camera's image is left out: depths come
/// from disparities, and would tell what was assumed of the motion between the exposures when they were
/// measured.
class RowMotionEstimator {
 public:
  RowMotionEstimator();
  RowMotionEstimator(RowMotionEstimator&&) noexcept;
  RowMotionEstimator& operator=(RowMotionEstimator&&) noexcept;
  ~RowMotionEstimator();

  RowMotion estimate(const RowMotionProblem& problem);

 private:
  std::unique_ptr<RowPoints> points_;  // reused: keeps its memory from call to call
};

}  // namespace cartvo::vo
