// Refinement of the newest pose against the last frames, and its covariance.
#include "vo_core/thesis/window_refinement.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>

#include "vo_core/thesis/prediction_error.hpp"

namespace cartvo::vo {
namespace {

constexpr double kConvergedStep = 1e-6;  // m and rad, step that ends the iterations
// Smallest variance of the errors relative to the assumed noise: identical images have none.
constexpr double kMinimumVariance = 0.01;
constexpr int kMinimumCells = 13;  // twice the number of parameters, and one

/// The normal equations of one linearisation.
struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();  // of the weighted squares, at fixed weights
  Vector6d gradient = Vector6d::Zero();
  Matrix6d derivative =
      Matrix6d::Zero();                // of the gradient, including the change of the weights with the error
  Matrix6d spread = Matrix6d::Zero();  // sum over cells of their gradients' squares
};

/// Gradient of the features of one cell.
struct CellGradient {
  Vector6d gradient = Vector6d::Zero();
  Matrix6d square = Matrix6d::Zero();  // sum of the squares, as if the errors were independent
  bool used = false;
};

/// Sums the gradients and the spread of the cells. At the minimum the cells' gradients cancel: of `used` ones
/// only used - 6 are free. Where that leaves few, their squares are unreliable, and those of the features are
/// used instead.
void addSpread(const std::array<CellGradient, kCovarianceCells>& cells, NormalEquations& sum) {
  const auto used =
      std::count_if(cells.begin(), cells.end(), [](const CellGradient& cell) { return cell.used; });
  const double free = static_cast<double>(used) - 6.0;
  for (const CellGradient& cell : cells) {
    sum.gradient += cell.gradient;
    if (used >= kMinimumCells)
      sum.spread += static_cast<double>(used) / free * cell.gradient * cell.gradient.transpose();
    else
      sum.spread += cell.square;
  }
}

NormalEquations linearise(const Eigen::Isometry3d& T_world_camera,
                          const std::vector<RefinementFeature>& features, double scale, double radius) {
  NormalEquations sum;
  std::array<CellGradient, kCovarianceCells> cells;
  const Eigen::Matrix3d R_camera_world = T_world_camera.linear().transpose();
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  for (const RefinementFeature& feature : features) {
    Vector6d feature_gradient = Vector6d::Zero();
    // A feature has one current point, however long its track: its observations share one weight.
    const double observation_weight = feature.weight / static_cast<double>(feature.earlier.size());
    for (const EarlierPoint& earlier : feature.earlier) {
      const Eigen::Vector3d predicted = T_camera_world * earlier.world;
      const Eigen::Vector3d error = predicted - feature.current;
      const Eigen::Matrix3d information =
          (R_camera_world * earlier.covariance * R_camera_world.transpose() + feature.current_covariance)
              .inverse() /
          (scale * scale);
      const double c = normalisedError(error, information);
      const double weight = observation_weight * errorWeight(c, radius);
      if (weight <= 0.0) continue;

      Eigen::Matrix<double, 3, 6> J;  // of the error by a perturbation of T_world_camera on the right
      J.leftCols<3>() = -Eigen::Matrix3d::Identity();
      J.rightCols<3>() = skew(predicted);
      const Eigen::Matrix<double, 6, 3> weighted = weight * J.transpose() * information;
      const Matrix6d square = weighted * J;
      const Vector6d slope = weighted * error;
      sum.hessian += square;
      sum.derivative += square;
      if (c > 1.0) sum.derivative -= slope * slope.transpose() / (weight * c * c);
      sum.spread += kMinimumVariance * weight * square;
      feature_gradient += slope;
    }
    CellGradient& cell = cells[feature.cell];
    cell.gradient += feature_gradient;
    cell.square += feature_gradient * feature_gradient.transpose();
    cell.used = cell.used || !feature_gradient.isZero();
  }
  addSpread(cells, sum);
  return sum;
}

/// Ratio of the errors under a pose to the assumed noise.
double scaleUnder(const Eigen::Isometry3d& T_world_camera, const std::vector<RefinementFeature>& features) {
  const Eigen::Matrix3d R_camera_world = T_world_camera.linear().transpose();
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  std::vector<double> errors;
  for (const RefinementFeature& feature : features) {
    const EarlierPoint& earlier = feature.earlier.front();
    const Eigen::Matrix3d covariance =
        R_camera_world * earlier.covariance * R_camera_world.transpose() + feature.current_covariance;
    errors.push_back(normalisedError(T_camera_world * earlier.world - feature.current, covariance.inverse()));
  }
  return errorScale(std::move(errors));
}

/// Whether each direction of the motion is constrained: no pivot is negligible beside the others.
bool wellConditioned(const Matrix6d& hessian) {
  const Eigen::LDLT<Matrix6d> factor(hessian);
  const auto pivots = factor.vectorD();
  return factor.info() == Eigen::Success && pivots.minCoeff() > 1e-9 * pivots.maxCoeff();
}

}  // namespace

RefinedPose refinePose(const Eigen::Isometry3d& T_world_camera,
                       const std::vector<RefinementFeature>& features, double scale, double radius,
                       const RefinementSettings& settings) {
  RefinedPose refined;
  refined.T_world_camera = T_world_camera;
  Eigen::Isometry3d pose = T_world_camera;
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    const NormalEquations equations = linearise(pose, features, scale, radius);
    if (!wellConditioned(equations.hessian)) return refined;
    const Vector6d step = -equations.hessian.ldlt().solve(equations.gradient);
    pose = pose * motionFromVector(step);
    if (step.lpNorm<Eigen::Infinity>() < kConvergedStep) break;
  }
  const NormalEquations equations = linearise(pose, features, scale, radius);
  if (!wellConditioned(equations.derivative)) return refined;
  const Matrix6d inverse = equations.derivative.inverse();
  const Matrix6d covariance = inverse * equations.spread * inverse.transpose();
  if (!covariance.allFinite()) return refined;
  refined.T_world_camera = pose;
  refined.covariance = 0.5 * (covariance + covariance.transpose());
  refined.scale = scaleUnder(pose, features);
  refined.converged = true;
  return refined;
}

}  // namespace cartvo::vo
