// Gauss-Newton estimation of pose, velocity and acceleration at an exposure from the rows of a pair.
#include "vo_core/estimation/row_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "vo_core/geometry/reprojection_lanes.hpp"

namespace cartvo::vo {
namespace {

constexpr int kIterations = 3;
constexpr int kMotion = 6, kMotionSize = RowInformation::kSize;  // after the pose
// Errors that all inverse depths have in common, because the pose of the right camera was not known exactly
// when they were measured, or its calibration: in proportion to rho, 1, the row, and rho times the column.
constexpr int kDepths = kMotion + kMotionSize, kDepthErrors = 4;
constexpr double kDepthStddevs[kDepthErrors] = {0.05, 0.01, 0.02,
                                                0.05};  // 1, 1/m, 1/m and 1 per focal length
constexpr int kReadout = kDepths + kDepthErrors;
constexpr int kUnknowns = kReadout + 1;
constexpr double kKnown = 1e-9;  // s, standard deviation of a known readout
constexpr std::size_t kMinimumPoints = 15;
constexpr double kFreedom = 4.0;  // degrees of freedom of the prior's t distribution

using StateMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using StateVector = Eigen::Matrix<double, kUnknowns, 1>;

/// Up to four points, one in each lane. Lanes beyond have no weight.
struct PointLanes {
  DoubleLanes ray[3]{}, ray_by_depth[3]{}, ray_by_readout[3]{};
  DoubleLanes inverse_depth{}, depth_information{};
  DoubleLanes pixel[2]{};      // px
  DoubleLanes instant{};       // s
  DoubleLanes share{};         // of the readout
  DoubleLanes precision[2]{};  // 1/px
  DoubleLanes weight{};
  DoubleLanes depth_errors[kDepthErrors]{};  // 1/m, effects of unit errors on the inverse depth
};

/// Vector of three coordinates in lanes.
struct VectorLanes {
  DoubleLanes x, y, z;
};

inline void cross(const VectorLanes& a, const VectorLanes& b, VectorLanes& product) {
  product = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Rotates a vector by minus a rotation vector, to second order.
inline void rotateBack(const VectorLanes& turn, const VectorLanes& vector, VectorLanes& rotated) {
  VectorLanes first, second;
  cross(turn, vector, first);
  cross(turn, first, second);
  rotated = {vector.x - first.x + 0.5 * second.x, vector.y - first.y + 0.5 * second.y,
             vector.z - first.z + 0.5 * second.z};
}

/// Iterate: changes of the pose and the readout (s) from the first guess, and the motion.
struct State {
  Eigen::Isometry3d change = Eigen::Isometry3d::Identity();
  ExposureMotion motion;
  double readout_change = 0.0;
};

/// Normal equations, summed separately in each lane.
struct StateEquations {
  DoubleLanes hessian[kUnknowns][kUnknowns]{};  // the lower triangle
  DoubleLanes gradient[kUnknowns]{};
};

/// One residual with its derivatives.
struct StateRow {
  DoubleLanes residual, weight, by_inverse_depth;
  DoubleLanes by_state[kUnknowns];
};

/// A point as the camera sees it at its instant.
struct InstantView {
  ViewLanes view;
  RayLanes by_depth, by_readout;  // derivatives of the ray; by the readout, that through the anchor
  PoseLanes column, row;
  DoubleLanes instant, half_square;
};

inline void see(const PointLanes& point, const State& state, InstantView& seen) {
  const Eigen::Matrix3d& R = state.change.linear();
  const Eigen::Vector3d& t = state.change.translation();
  const auto& [velocity, acceleration] = state.motion;
  seen.instant = point.instant + state.readout_change * point.share;
  seen.half_square = 0.5 * seen.instant * seen.instant;
  DoubleLanes step[6];
  for (int i = 0; i < 6; ++i)
    step[i] = velocity[i] * seen.instant + acceleration[i] * seen.half_square;
  const VectorLanes shift{step[0], step[1], step[2]}, turn{step[3], step[4], step[5]};
  const auto at_instant = [&](const DoubleLanes* from, const DoubleLanes& depth, RayLanes& to) {
    const DoubleLanes x = from[0] - depth * t.x(), y = from[1] - depth * t.y(), z = from[2] - depth * t.z();
    const VectorLanes moved{R(0, 0) * x + R(1, 0) * y + R(2, 0) * z - depth * shift.x,
                            R(0, 1) * x + R(1, 1) * y + R(2, 1) * z - depth * shift.y,
                            R(0, 2) * x + R(1, 2) * y + R(2, 2) * z - depth * shift.z};
    VectorLanes turned;
    rotateBack(turn, moved, turned);
    to = {turned.x, turned.y, turned.z};
  };
  RayLanes ray;
  at_instant(point.ray, point.inverse_depth, ray);
  at_instant(point.ray_by_depth, 1.0 + DoubleLanes{}, seen.by_depth);
  at_instant(point.ray_by_readout, DoubleLanes{}, seen.by_readout);
  seen.view = viewOf(ray);
  PlaceLanes place{};
  place.inverse_depth = point.inverse_depth;
  seen.column = columnByCamera(seen.view, place);
  seen.row = rowByCamera(seen.view, place);
}

/// Sets the derivatives by pose, velocity, acceleration, depths and readout: those by the pose times
/// `factor`, and times what each of them moves the camera by at the instant.
inline void setDerivatives(const PoseLanes& by_pose, const DoubleLanes& factor, const PointLanes& point,
                           const InstantView& seen, const ExposureMotion& motion, StateRow& row) {
  for (int i = 0; i < kDepthErrors; ++i)
    row.by_state[kDepths + i] = row.by_inverse_depth * point.depth_errors[i];
  DoubleLanes by_instant{};
  for (int i = 0; i < 6; ++i) {
    const DoubleLanes by = factor * by_pose.value[i];
    row.by_state[i] = by;
    row.by_state[6 + i] = seen.instant * by;
    row.by_state[12 + i] = seen.half_square * by;
    by_instant += by * (motion.velocity[i] + motion.acceleration[i] * seen.instant);
  }
  row.by_state[kReadout] = point.share * by_instant;
}

inline void addRow(const StateRow& row, StateEquations& equations, StateRow& depth) {
  for (int i = 0; i < kUnknowns; ++i) {
    const DoubleLanes weighted = row.weight * row.by_state[i];
    equations.gradient[i] += weighted * row.residual;
    depth.by_state[i] += weighted * row.by_inverse_depth;
    for (int j = 0; j <= i; ++j)
      equations.hessian[i][j] += weighted * row.by_state[j];
  }
  depth.weight += row.weight * row.by_inverse_depth * row.by_inverse_depth;
  depth.residual += row.weight * row.by_inverse_depth * row.residual;
}

CARTVO_TARGET_CLONES
void addPoints(const StereoCamera& camera, double robust_width, const std::vector<PointLanes>& points,
               const State& state, StateEquations& equations) {
  const double f = camera.focal_length;
  const double robustness = 1.0 / (robust_width * robust_width);
  for (const PointLanes& point : points) {
    InstantView seen;
    see(point, state, seen);
    const PixelLanes by_depth = viewByRay(seen.view, seen.by_depth);
    const DoubleLanes scale[2] = {f * point.precision[0], f * point.precision[1]};
    StateRow rows[2];
    rows[0].residual = point.precision[0] * (point.pixel[0] - camera.cx) - scale[0] * seen.view.x;
    rows[1].residual = point.precision[1] * (point.pixel[1] - camera.cy) - scale[1] * seen.view.y;
    rows[0].by_inverse_depth = scale[0] * by_depth.x;
    rows[1].by_inverse_depth = scale[1] * by_depth.y;
    setDerivatives(seen.column, scale[0], point, seen, state.motion, rows[0]);
    setDerivatives(seen.row, scale[1], point, seen, state.motion, rows[1]);
    const PixelLanes by_anchor_readout = viewByRay(seen.view, seen.by_readout);
    rows[0].by_state[kReadout] += scale[0] * by_anchor_readout.x;
    rows[1].by_state[kReadout] += scale[1] * by_anchor_readout.y;
    // The depth is not known exactly: without its share, residuals of new landmarks would pass for outliers.
    const DoubleLanes depth_variance = 1.0 / point.depth_information;
    DoubleLanes square{};
    for (const StateRow& row : rows)
      square += 0.5 * row.residual * row.residual /
                (1.0 + depth_variance * row.by_inverse_depth * row.by_inverse_depth);
    rows[0].weight = rows[1].weight = point.weight / (1.0 + robustness * square);
    StateRow depth{};
    for (const StateRow& row : rows)
      addRow(row, equations, depth);
    // The depth's own weight follows that of the point; the constant is for lanes without one.
    const DoubleLanes variance = 1.0 / (depth.weight + rows[0].weight * point.depth_information + 1e-12);
    for (int i = 0; i < kUnknowns; ++i) {
      const DoubleLanes scaled = variance * depth.by_state[i];
      equations.gradient[i] -= scaled * depth.residual;
      for (int j = 0; j <= i; ++j)
        equations.hessian[i][j] -= scaled * depth.by_state[j];
    }
  }
}

void fill(const RowMotionProblem& problem, std::vector<PointLanes>& lanes) {
  lanes.clear();
  lanes.reserve(problem.points.capacity() / kDoubleLanes + 1);
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const int lane = static_cast<int>(i) % kDoubleLanes;
    if (lane == 0) {
      PointLanes& empty = lanes.emplace_back();
      empty.ray[2] = empty.depth_information = 1.0 + DoubleLanes{};
    }
    PointLanes& into = lanes.back();
    const RowPoint& point = problem.points[i];
    for (int axis = 0; axis < 3; ++axis) {
      into.ray[axis][lane] = point.ray[axis];
      into.ray_by_depth[axis][lane] = point.ray_by_inverse_depth[axis];
      into.ray_by_readout[axis][lane] = point.ray_by_readout[axis];
    }
    into.inverse_depth[lane] = point.inverse_depth;
    into.depth_information[lane] = point.inverse_depth_information;
    for (int axis = 0; axis < 2; ++axis) {
      into.pixel[axis][lane] = point.pixel[axis];
      into.precision[axis][lane] = 1.0 / (problem.noise[point.level].pixel * point.relative_noise[axis]);
    }
    into.instant[lane] = point.instant;
    into.share[lane] = point.share;
    into.depth_errors[0][lane] = point.inverse_depth;
    into.depth_errors[1][lane] = 1.0;
    into.depth_errors[2][lane] = point.bearing.y();
    into.depth_errors[3][lane] = point.inverse_depth * point.bearing.x();
    into.weight[lane] = point.weight;
  }
}

/// The normal equations with all lanes summed.
struct StateSums {
  StateMatrix hessian;
  StateVector gradient;

  explicit StateSums(const StateEquations& equations) {
    for (int i = 0; i < kUnknowns; ++i) {
      gradient[i] = sumOf(equations.gradient[i]);
      for (int j = 0; j <= i; ++j)
        hessian(i, j) = hessian(j, i) = sumOf(equations.hessian[i][j]);
    }
  }

  /// Adds a prior of one unknown that is `difference` above its present value.
  void addPrior(int unknown, double information, double difference) {
    hessian(unknown, unknown) += information;
    gradient[unknown] += information * difference;
  }
};

/// Sets what the rows tell of the motion, all else eliminated, and the covariances. `without_prior`:
/// equations without the prior of the motion; `with_prior`: with it, factored.
void conclude(const StateSums& without_prior, const Eigen::LDLT<StateMatrix>& with_prior,
              const ExposureMotion& at, RowMotion& result) {
  constexpr int kAfter = kUnknowns - kDepths, kOthers = 6 + kAfter;
  using OthersMatrix = Eigen::Matrix<double, kOthers, kOthers>;
  using CrossMatrix = Eigen::Matrix<double, kOthers, kMotionSize>;
  const StateMatrix& hessian = without_prior.hessian;
  OthersMatrix others;
  others << hessian.topLeftCorner<6, 6>(), hessian.topRightCorner<6, kAfter>(),
      hessian.bottomLeftCorner<kAfter, 6>(), hessian.bottomRightCorner<kAfter, kAfter>();
  CrossMatrix cross;
  cross << hessian.block<6, kMotionSize>(0, kMotion), hessian.block<kAfter, kMotionSize>(kDepths, kMotion);
  Eigen::Matrix<double, kOthers, 1> gradient;
  gradient << without_prior.gradient.head<6>(), without_prior.gradient.tail<kAfter>();
  const CrossMatrix solved = Eigen::LDLT<OthersMatrix>(others).solve(cross);
  result.rows.information =
      hessian.block<kMotionSize, kMotionSize>(kMotion, kMotion) - cross.transpose() * solved;
  RowInformation::Vector now;
  now << at.velocity, at.acceleration;
  result.rows.gradient = without_prior.gradient.segment<kMotionSize>(kMotion) -
                         solved.transpose() * gradient + result.rows.information * now;
  const StateMatrix covariance = with_prior.solve(StateMatrix::Identity());
  result.covariance = covariance.block<kMotionSize, kMotionSize>(kMotion, kMotion);
  // Of the pose: what is added to the covariance with all else known.
  result.pose_covariance_by_motion =
      covariance.topLeftCorner<6, 6>() -
      Eigen::LDLT<Matrix6d>(hessian.topLeftCorner<6, 6>()).solve(Matrix6d::Identity());
}

/// Sets the equation for the readout. `sums`: equations with the priors of all other unknowns.
void concludeReadout(const StateSums& sums, double readout_change, RowMotion& result) {
  constexpr int n = kReadout;
  using OthersMatrix = Eigen::Matrix<double, n, n>;
  using OthersVector = Eigen::Matrix<double, n, 1>;
  const Eigen::LDLT<OthersMatrix> factor(sums.hessian.topLeftCorner<n, n>());
  const OthersVector by_readout = factor.solve(OthersVector(sums.hessian.col(n).head<n>()));
  result.readout.information = sums.hessian(n, n) - sums.hessian.col(n).head<n>().dot(by_readout);
  result.readout.gradient = sums.gradient[n] - by_readout.dot(sums.gradient.head<n>()) +
                            result.readout.information * readout_change;
}

}  // namespace

struct RowMotionEstimator::Work {
  std::vector<PointLanes> points;
  StateEquations equations;
};

RowMotionEstimator::RowMotionEstimator() : work_(std::make_unique<Work>()) {}
RowMotionEstimator::RowMotionEstimator(RowMotionEstimator&&) noexcept = default;
RowMotionEstimator& RowMotionEstimator::operator=(RowMotionEstimator&&) noexcept = default;
RowMotionEstimator::~RowMotionEstimator() = default;

RowMotion RowMotionEstimator::estimate(const RowMotionProblem& problem) {
  RowMotion result;
  if (problem.points.size() < kMinimumPoints) return result;
  auto& [points, equations] = *work_;
  fill(problem, points);
  State state;
  state.motion = problem.start;
  const double readout_information = 1.0 / std::pow(std::max(problem.readout_stddev, kKnown), 2);
  RowInformation::Vector prior_information = problem.variances.cwiseInverse();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    equations = {};
    addPoints(problem.camera, problem.robust_width, points, state, equations);
    StateSums sums(equations);
    for (int i = 0; i < kDepthErrors; ++i)
      sums.addPrior(kDepths + i, 1.0 / (kDepthStddevs[i] * kDepthStddevs[i]), 0.0);
    RowInformation::Vector difference;
    difference << problem.expected.velocity - state.motion.velocity,
        problem.expected.acceleration - state.motion.acceleration;
    if (iteration > 0) {
      const auto squares = difference.array().square() / problem.variances.array();
      prior_information = (kFreedom + 1.0) / ((kFreedom + squares) * problem.variances.array());
    }
    StateSums with_motion = sums;
    for (int i = 0; i < kMotionSize; ++i)
      with_motion.addPrior(kMotion + i, prior_information[i], difference[i]);
    StateSums all = with_motion;
    all.addPrior(kReadout, readout_information, -state.readout_change);
    const Eigen::LDLT<StateMatrix> factor(all.hessian);
    const StateVector step = factor.solve(all.gradient);
    if (factor.info() != Eigen::Success || !step.allFinite()) return result;
    if (iteration + 1 == kIterations) {
      concludeReadout(with_motion, state.readout_change, result);
      sums.addPrior(kReadout, readout_information, -state.readout_change);
      conclude(sums, factor, state.motion, result);
    }
    state.change = orthonormalised(state.change * motionFromVector(step.head<6>()));
    state.motion.velocity += step.segment<6>(6);
    state.motion.acceleration += step.segment<6>(12);
    state.readout_change += step[kReadout];
  }
  result.pose_change = vectorFromMotion(state.change);
  result.motion = state.motion;
  result.readout_change = state.readout_change;
  result.converged = true;
  return result;
}

}  // namespace cartvo::vo
