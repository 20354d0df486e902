// Board pose from the corners in one image, by a homography between board and rays.
#include "calib/board/board_pose.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

#include "calib/model/lens.hpp"

namespace cartvo::calib {
namespace {

using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// Shifts and scales the points of the plane to mean 0 and mean distance about 1, to condition the
/// homography's equations.
Eigen::Matrix3d normaliser(const std::vector<SeenCorner>& seen,
                           const std::vector<Eigen::Vector2d>& board_corners) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const SeenCorner& corner : seen)
    mean += board_corners[static_cast<std::size_t>(corner.id)] / static_cast<double>(seen.size());
  double distance = 0.0;
  for (const SeenCorner& corner : seen) {
    distance +=
        (board_corners[static_cast<std::size_t>(corner.id)] - mean).norm() / static_cast<double>(seen.size());
  }
  Eigen::Matrix3d N = Eigen::Matrix3d::Identity();
  N(0, 0) = N(1, 1) = 1.0 / distance;
  N.topRightCorner<2, 1>() = -mean / distance;
  return N;
}

std::vector<Eigen::Vector3d> raysOf(const CameraModel& camera, const std::vector<SeenCorner>& seen) {
  const Lens lens(camera);
  std::vector<Eigen::Vector3d> rays;
  for (const SeenCorner& corner : seen) {
    rays.push_back(lens.undistort({(corner.pixel.x() - camera.cx) / camera.fx,
                                   (corner.pixel.y() - camera.cy) / camera.fy})
                       .normalized());
  }
  return rays;
}

}  // namespace

std::optional<Eigen::Isometry3d> boardPose(const CameraModel& camera, const std::vector<SeenCorner>& seen,
                                           const std::vector<Eigen::Vector2d>& board_corners) {
  constexpr std::size_t kMinCorners = 4;
  if (seen.size() < kMinCorners) return std::nullopt;
  const Eigen::Matrix3d N = normaliser(seen, board_corners);
  std::vector<Eigen::Vector3d> rays;
  try {
    rays = raysOf(camera, seen);
  } catch (const std::invalid_argument&) {  // beyond the radius where the distortion folds
    return std::nullopt;
  }
  // ray x (H point) = 0: three equations, two of them independent, in the nine elements of H row by row.
  Matrix9d normal = Matrix9d::Zero();
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Eigen::Vector2d& corner = board_corners[static_cast<std::size_t>(seen[i].id)];
    const Eigen::RowVector3d point = (N * corner.homogeneous()).transpose();
    const Eigen::Vector3d& d = rays[i];
    Eigen::Matrix<double, 3, 9> A;
    A << Eigen::RowVector3d::Zero(), -d.z() * point, d.y() * point,  //
        d.z() * point, Eigen::RowVector3d::Zero(), -d.x() * point,   //
        -d.y() * point, d.x() * point, Eigen::RowVector3d::Zero();
    normal += A.transpose() * A;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix9d> solver(normal);
  // The null space has more than one dimension: the corners are collinear.
  if (!(solver.eigenvalues()[1] > 1e-9 * solver.eigenvalues()[8])) return std::nullopt;
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  Eigen::Matrix3d H = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data()) * N;
  const Eigen::Vector2d& first = board_corners[static_cast<std::size_t>(seen.front().id)];
  if (rays.front().dot(H * first.homogeneous()) < 0.0) H = -H;
  H *= 2.0 / (H.col(0).norm() + H.col(1).norm());
  Eigen::Matrix3d R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d T_camera_board = Eigen::Isometry3d::Identity();
  T_camera_board.linear() = svd.matrixU() * svd.matrixV().transpose();
  T_camera_board.translation() = H.col(2);
  if (!T_camera_board.matrix().allFinite() || !(R.determinant() > 0.0)) return std::nullopt;
  return T_camera_board;
}

}  // namespace cartvo::calib
