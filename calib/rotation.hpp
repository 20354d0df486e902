#pragma once

#include <Eigen/Geometry>

namespace cartvo {

/// Whether a matrix read from a file is a rotation, up to the digits that files carry.
inline bool isRotation(const Eigen::Matrix3d& matrix) {
  constexpr double kTolerance = 1e-5;
  return matrix.allFinite() && (matrix * matrix.transpose()).isIdentity(kTolerance) &&
         matrix.determinant() > 0.0;
}

/// The matrix itself if it is orthonormal to the last digits, else the rotation it was rounded from.
inline Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& matrix) {
  constexpr double kRounding = 1e-14;
  if ((matrix * matrix.transpose()).isIdentity(kRounding)) return matrix;
  return Eigen::Quaterniond(matrix).normalized().toRotationMatrix();
}

}  // namespace cartvo
