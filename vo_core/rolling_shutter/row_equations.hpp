#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "vo_core/rolling_shutter/row_motion.hpp"

// Normal equations of the rows of an image, for pose and motion of its camera.

namespace cartvo::vo {

/// Order of the unknowns.
struct RowUnknowns {
  static constexpr int kPose = 0;    ///< 6, on the right of the first guess
  static constexpr int kMotion = 6;  ///< see RowInformation
  static constexpr int kDepths = kMotion + RowInformation::kSize;
  /// Errors that all inverse depths have in common, because the pose of the right camera was not known
  /// exactly when they were measured, or its calibration: in proportion to rho, 1, the row, and rho times the
  /// column.
  static constexpr int kDepthErrors = 4;
  static constexpr int kReadout = kDepths + kDepthErrors;
  static constexpr int kSize = kReadout + 1;

  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;
};

/// Iterate: change of the pose from the first guess, and the motion. The readout is considered, not
/// estimated.
struct RowState {
  Eigen::Isometry3d change = Eigen::Isometry3d::Identity();
  ExposureMotion motion;
};

/// Normal equations.
struct RowEquations {
  RowUnknowns::Matrix hessian = RowUnknowns::Matrix::Zero();
  RowUnknowns::Vector gradient = RowUnknowns::Vector::Zero();

  /// Adds a prior of one unknown that is `difference` above its present value.
  void addPrior(int unknown, double information, double difference) {
    hessian(unknown, unknown) += information;
    gradient[unknown] += information * difference;
  }
};

/// The points of a problem, several at a time. Reused: keeps its memory.
class RowPoints {
 public:
  RowPoints();
  RowPoints(RowPoints&&) noexcept;
  RowPoints& operator=(RowPoints&&) noexcept;
  ~RowPoints();

  void set(const RowMotionProblem& problem);
  /// Equations at `state`, with Cauchy weights and the points' inverse depths eliminated.
  RowEquations equationsAt(const RowState& state) const;

 private:
  struct Lanes;
  std::unique_ptr<Lanes> lanes_;
};

}  // namespace cartvo::vo
