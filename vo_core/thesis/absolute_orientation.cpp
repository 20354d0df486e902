// Horn's closed-form alignment of two point clouds.
#include "vo_core/thesis/absolute_orientation.hpp"

#include <Eigen/Eigenvalues>

namespace cartvo::vo {
namespace {

// Gap between the two greatest eigenvalues, relative to the spread of the points, below which the rotation is
// undetermined.
constexpr double kMinimumGap = 1e-6;

}  // namespace

std::optional<Eigen::Isometry3d> absoluteOrientation(const std::vector<PointPair>& pairs) {
  double weight = 0.0;
  int count = 0;
  Eigen::Vector3d from_centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d to_centroid = Eigen::Vector3d::Zero();
  for (const PointPair& pair : pairs) {
    if (pair.weight <= 0.0) continue;
    ++count;
    weight += pair.weight;
    from_centroid += pair.weight * pair.from;
    to_centroid += pair.weight * pair.to;
  }
  if (count < 3) return std::nullopt;
  from_centroid /= weight;
  to_centroid /= weight;

  Eigen::Matrix3d M = Eigen::Matrix3d::Zero();  // Horn's M: sums of products of coordinates
  double spread = 0.0;
  for (const PointPair& pair : pairs) {
    if (pair.weight <= 0.0) continue;
    const Eigen::Vector3d from = pair.from - from_centroid;
    const Eigen::Vector3d to = pair.to - to_centroid;
    M += pair.weight * from * to.transpose();
    spread += pair.weight * 0.5 * (from.squaredNorm() + to.squaredNorm());
  }

  Eigen::Matrix4d N;
  N << M(0, 0) + M(1, 1) + M(2, 2), M(1, 2) - M(2, 1), M(2, 0) - M(0, 2), M(0, 1) - M(1, 0),  //
      M(1, 2) - M(2, 1), M(0, 0) - M(1, 1) - M(2, 2), M(0, 1) + M(1, 0), M(2, 0) + M(0, 2),   //
      M(2, 0) - M(0, 2), M(0, 1) + M(1, 0), -M(0, 0) + M(1, 1) - M(2, 2), M(1, 2) + M(2, 1),  //
      M(0, 1) - M(1, 0), M(2, 0) + M(0, 2), M(1, 2) + M(2, 1), -M(0, 0) - M(1, 1) + M(2, 2);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(N);  // eigenvalues in ascending order
  if (!(solver.eigenvalues()[3] - solver.eigenvalues()[2] > kMinimumGap * spread)) return std::nullopt;
  const Eigen::Vector4d q = solver.eigenvectors().col(3);

  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  T.translation() = to_centroid - T.linear() * from_centroid;
  return T;
}

}  // namespace cartvo::vo
