// Gauss-Newton estimation of pose and motion at an exposure from the rows of a picture.
#include "vo_core/rolling_shutter/row_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "vo_core/rolling_shutter/row_equations.hpp"

namespace cartvo::vo {
namespace {

constexpr int kIterations = 3;
constexpr double kSmallDecrease = 0.01;  // of the cost, by a step that is far below the noise
constexpr int kMotionSize = RowInformation::kSize;
constexpr int kMotion = RowUnknowns::kMotion, kDepths = RowUnknowns::kDepths;
constexpr int kReadout = RowUnknowns::kReadout;
constexpr std::size_t kMinimumPoints = 15;

constexpr int kEstimated = kReadout;  // all unknowns but the readout, which is considered
using EstimatedMatrix = Eigen::Matrix<double, kEstimated, kEstimated>;
using EstimatedVector = Eigen::Matrix<double, kEstimated, 1>;

/// Sets what the rows tell of the motion, all else eliminated, and the covariances. `without_prior`:
/// equations without the prior of the motion; `with_prior`: with it, factored.
void conclude(const RowEquations& without_prior, const Eigen::LDLT<EstimatedMatrix>& with_prior,
              const ExposureMotion& at, RowMotion& result) {
  constexpr int kAfter = kEstimated - kDepths, kOthers = 6 + kAfter;
  using OthersMatrix = Eigen::Matrix<double, kOthers, kOthers>;
  using CrossMatrix = Eigen::Matrix<double, kOthers, kMotionSize>;
  const EstimatedMatrix hessian = without_prior.hessian.topLeftCorner<kEstimated, kEstimated>();
  OthersMatrix others;
  others << hessian.topLeftCorner<6, 6>(), hessian.topRightCorner<6, kAfter>(),
      hessian.bottomLeftCorner<kAfter, 6>(), hessian.bottomRightCorner<kAfter, kAfter>();
  CrossMatrix cross;
  cross << hessian.block<6, kMotionSize>(0, kMotion), hessian.block<kAfter, kMotionSize>(kDepths, kMotion);
  Eigen::Matrix<double, kOthers, 1> gradient;
  gradient << without_prior.gradient.head<6>(), without_prior.gradient.segment<kAfter>(kDepths);
  const CrossMatrix solved = Eigen::LDLT<OthersMatrix>(others).solve(cross);
  result.rows.information =
      hessian.block<kMotionSize, kMotionSize>(kMotion, kMotion) - cross.transpose() * solved;
  const RowInformation::Vector now = vectorOf(at);
  result.rows.gradient = without_prior.gradient.segment<kMotionSize>(kMotion) -
                         solved.transpose() * gradient + result.rows.information * now;
  const EstimatedMatrix covariance = with_prior.solve(EstimatedMatrix::Identity());
  result.covariance = covariance.block<kMotionSize, kMotionSize>(kMotion, kMotion);
  // Of the pose: what is added to the covariance with all else known.
  result.pose_covariance_by_motion =
      covariance.topLeftCorner<6, 6>() -
      Eigen::LDLT<Matrix6d>(hessian.topLeftCorner<6, 6>()).solve(Matrix6d::Identity());
}

/// Sets the equation for the readout, and the sensitivity to it. `with_prior`: equations with the priors of
/// all unknowns but the readout, and these factored.
void concludeReadout(const RowEquations& with_prior, const Eigen::LDLT<EstimatedMatrix>& factor,
                     RowMotion& result) {
  const EstimatedVector by_readout = with_prior.hessian.col(kReadout).head<kEstimated>();
  const EstimatedVector error = factor.solve(by_readout);
  result.error_by_readout = error.segment<kMotionSize>(kMotion);
  result.readout.information = with_prior.hessian(kReadout, kReadout) - by_readout.dot(error);
  result.readout.gradient = with_prior.gradient[kReadout] - error.dot(with_prior.gradient.head<kEstimated>());
}

}  // namespace

RowMotionEstimator::RowMotionEstimator() : points_(std::make_unique<RowPoints>()) {}
RowMotionEstimator::RowMotionEstimator(RowMotionEstimator&&) noexcept = default;
RowMotionEstimator& RowMotionEstimator::operator=(RowMotionEstimator&&) noexcept = default;
RowMotionEstimator::~RowMotionEstimator() = default;

RowMotion RowMotionEstimator::estimate(const RowMotionProblem& problem) {
  RowMotion result;
  if (problem.points.size() < kMinimumPoints) return result;
  points_->set(problem);
  RowState state;
  state.motion = problem.start;
  const RollingShutterSettings& settings = problem.settings;
  const MotionPrior prior{vectorOf(problem.expected), problem.variances, settings.prior_freedom};
  RowInformation::Vector prior_information = prior.variances.cwiseInverse();
  const double depth_stddevs[RowUnknowns::kDepthErrors] = {
      problem.depth_scale_stddev, settings.depth_offset_stddev, settings.depth_offset_stddev,
      problem.depth_scale_stddev};
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    RowEquations sums = points_->equationsAt(state);
    for (int i = 0; i < RowUnknowns::kDepthErrors; ++i)
      sums.addPrior(kDepths + i, 1.0 / (depth_stddevs[i] * depth_stddevs[i]), 0.0);
    const RowInformation::Vector difference = prior.mean - vectorOf(state.motion);
    if (iteration > 0) prior_information = prior.informationAt(vectorOf(state.motion));
    RowEquations with_motion = sums;
    for (int i = 0; i < kMotionSize; ++i)
      with_motion.addPrior(kMotion + i, prior_information[i], difference[i]);
    const EstimatedVector gradient = with_motion.gradient.head<kEstimated>();
    const Eigen::LDLT<EstimatedMatrix> factor(with_motion.hessian.topLeftCorner<kEstimated, kEstimated>());
    const EstimatedVector step = factor.solve(gradient);
    if (factor.info() != Eigen::Success || !step.allFinite()) return result;
    const bool last = iteration + 1 == kIterations || (iteration > 0 && step.dot(gradient) < kSmallDecrease);
    if (last) {
      conclude(sums, factor, state.motion, result);
      concludeReadout(with_motion, factor, result);
    }
    state.change = orthonormalised(state.change * motionFromVector(step.head<6>()));
    state.motion = motionOf(vectorOf(state.motion) + step.segment<kMotionSize>(kMotion));
    if (last) break;
  }
  result.motion = state.motion;
  result.converged = true;
  return result;
}

}  // namespace cartvo::vo
