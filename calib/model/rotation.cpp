// Rotation between two sets of vectors.
#include "calib/model/rotation.hpp"

#include <Eigen/SVD>

namespace cartvo::calib {

Eigen::Matrix3d bestRotation(const Eigen::Matrix3d& products) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace cartvo::calib
