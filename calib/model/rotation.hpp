#pragma once

#include <Eigen/Geometry>

namespace cartvo::calib {

/// Whether a matrix is a rotation, within the rounding of files (1e-5).
inline bool isRotation(const Eigen::Matrix3d& matrix) {
  constexpr double kTolerance = 1e-5;
  return matrix.allFinite() && (matrix * matrix.transpose()).isIdentity(kTolerance) &&
         matrix.determinant() > 0.0;
}

/// The rotation nearest to a rounded one; the matrix itself if it is orthonormal within 1e-14.
inline Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& matrix) {
  constexpr double kRounding = 1e-14;
  if ((matrix * matrix.transpose()).isIdentity(kRounding)) return matrix;
  return Eigen::Quaterniond(matrix).normalized().toRotationMatrix();
}

}  // namespace cartvo::calib
