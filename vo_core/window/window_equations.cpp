// Normal equations of a window.
#include "vo_core/window/window_equations.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

constexpr double kGate = 6.0;              // mean square of a landmark's residuals over their scales
constexpr double kLargestSquare = 60.0;    // of an image in that mean
constexpr double kLeastInformation = 1.0;  // m^2, of an inverse depth that nothing shows
constexpr double kLeastFreedom = 100.0;    // of residuals from which a scale is estimated
constexpr double kLeastScale = 0.01, kLargestScale = 1.0;  // px
constexpr double kLargestCommon = 0.9;                     // see WindowNoise::common
constexpr double kLargestCommonSquare = 16.0;              // of residuals that it is estimated from
constexpr int kBands = 41;  // of rows, between which the camera accelerates uniformly

/// Adds the products of `by_state` (columns as ObservationState) with the derivatives of those states by the
/// unknowns: a linear map of rows to rows.
template <typename ByState, typename Result>
void addByUnknowns(const WindowBand& band, const ByState& by_state, Result& result) {
  const auto add_camera = [&](const Trajectory::Instant& instant, int position, int turn) {
    for (int i = 0; i < Trajectory::kSupport; ++i) {
      const Eigen::Index at = columnOf(instant.first + i);
      result.template middleCols<3>(at) += instant.by_knot[i] * by_state.template middleCols<3>(position);
      result.template middleCols<3>(at + 3).noalias() +=
          by_state.template middleCols<3>(turn) * instant.turn_by_knot[i];
    }
  };
  add_camera(band.left, kRowLeftPosition, kRowLeftTurn);
  add_camera(band.right, kRowRightPosition, kRowRightTurn);
  result.col(kLeftReadout) += by_state.col(kRowLeftReadout);
  result.col(kRightReadout) += by_state.col(kRowRightReadout);
  result.col(kOffset) += by_state.col(kRowOffset);
  result.template middleCols<kRigStates>(kPitch) += by_state.template middleCols<kRigStates>(kRowRig);
}

}  // namespace

void WindowNoiseSums::add(int level, const ObservationEquations& equations,
                          const Eigen::Matrix3d& covariance) {
  Level& sums = levels_[static_cast<std::size_t>(level)];
  const Eigen::Matrix4d explained = equations.by_place * covariance * equations.by_place.transpose();
  for (int image = 0; image < 2; ++image) {
    if (!(equations.precision[2 * image] > 0.0)) continue;
    const double square = equations.squareIn(image), weight = studentWeight(square);
    Sum& sum = image == 0 ? sums.left : sums.right;
    sum.squares += weight * square;
    for (int row = 2 * image; row < 2 * image + 2; ++row)
      sum.freedom +=
          1.0 - std::min(1.0, kStudentInformation * weight * equations.precision[row] * explained(row, row));
  }
  if (!(equations.precision[2] > 0.0)) return;
  // Weights that fall with the residuals would count their products less than their expected ones.
  if (std::max(equations.squareIn(0), equations.squareIn(1)) > kLargestCommonSquare) return;
  for (int row = 0; row < 2; ++row) {
    const double precision = equations.precision[row];
    sums.common +=
        precision * (equations.residual[row] * equations.residual[row + 2] + explained(row, row + 2));
    sums.by_left += precision * (equations.residual[row] * equations.residual[row] + explained(row, row));
  }
}

WindowNoises WindowNoiseSums::concluded(const WindowNoises& before) const {
  WindowNoises noises = before;
  const auto scaled = [](double scale, const Sum& sum) {
    if (sum.freedom < kLeastFreedom) return scale;
    return std::clamp(scale * std::sqrt(sum.squares / sum.freedom), kLeastScale, kLargestScale);
  };
  for (std::size_t level = 0; level < noises.size(); ++level) {
    noises[level].left = scaled(before[level].left, levels_[level].left);
    noises[level].right = scaled(before[level].right, levels_[level].right);
    if (levels_[level].right.freedom < kLeastFreedom) continue;
    noises[level].common = std::clamp(before[level].common + levels_[level].common / levels_[level].by_left,
                                      -kLargestCommon, kLargestCommon);
  }
  return noises;
}

WindowEquations::Band& WindowEquations::bandOf(const WindowProblem& problem,
                                               const WindowObservation& observation) {
  const int row = std::clamp(static_cast<int>((observation.left_share + 0.5) * kBands), 0, kBands - 1);
  Band& band = bands_[static_cast<std::size_t>(observation.pair) * kBands + static_cast<std::size_t>(row)];
  if (band.used) return band;
  band.used = true;
  band.information.setZero();
  band.gradient.setZero();
  const double share = (row + 0.5) / kBands - 0.5;
  band.middle.left_time = problem.leftTime(observation.pair, share);
  band.middle.right_time = problem.rightTime(observation.pair, share);
  band.middle.left = problem.trajectory.at(band.middle.left_time);
  band.middle.right = problem.trajectory.at(band.middle.right_time);
  return band;
}

/// Adds a landmark's observations to the equations of their bands, and sets its coupling to the unknowns in
/// three columns.
WindowEquations::Eliminated WindowEquations::eliminate(const WindowProblem& problem,
                                                       const WindowLandmark& landmark, bool gated,
                                                       double scale, Eigen::Index columns) {
  Eliminated result;
  FixedVector<ObservationEquations, kMaximumWindowPairs> rows;
  double squares = 0.0, freedom = -3.0;
  for (const WindowObservation& observation : landmark.observations) {
    const auto seen = equationsOf(problem, bandOf(problem, observation).middle, landmark, observation, scale);
    if (!seen) return result;
    rows.push_back(*seen);
    for (int image = 0; image < (observation.stereo ? 2 : 1); ++image) {
      squares += std::min(seen->squareIn(image), kLargestSquare);
      freedom += 2.0;
    }
  }
  if (freedom < 0.0 || (gated && squares > kGate * std::max(freedom, 1.0))) return result;

  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information(2, 2) = kLeastInformation;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  cross_.setZero(3, information_.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ObservationEquations& row = rows[i];
    Band& band = bandOf(problem, landmark.observations[i]);
    Eigen::Vector4d weight = kStudentInformation * row.precision;
    weight.head<2>() *= studentWeight(row.squareIn(0));
    weight.tail<2>() *= studentWeight(row.squareIn(1));
    const Eigen::Matrix<double, kObservationStates, 4> weighted =
        row.by_state.transpose() * weight.asDiagonal();
    band.information += weighted.lazyProduct(row.by_state);
    band.gradient += weighted.lazyProduct(row.residual);
    const Eigen::Matrix<double, 3, 4> weighted_place = row.by_place.transpose() * weight.asDiagonal();
    information.noalias() += weighted_place * row.by_place;
    gradient.noalias() += weighted_place * row.residual;
    const Eigen::Matrix<double, 3, kObservationStates> by_state = weighted_place.lazyProduct(row.by_state);
    addByUnknowns(band.middle, by_state, cross_);
  }
  const Eigen::LLT<Eigen::Matrix3d> factor(information);
  if (factor.info() != Eigen::Success) return result;
  result.used = true;
  result.root = factor.matrixL();
  gradients_.segment<3>(columns) = factor.matrixL().solve(gradient);
  const Eigen::Matrix3d inverse = factor.matrixL().solve(Eigen::Matrix3d::Identity());
  couplings_.middleCols<3>(columns) = cross_.transpose().lazyProduct(inverse.transpose());
  const Eigen::Matrix3d covariance = factor.solve(Eigen::Matrix3d::Identity());
  for (const ObservationEquations& row : rows)
    sums_.add(landmark.level, row, covariance);
  return result;
}

void WindowEquations::addBand(const Band& band) {
  const Trajectory::Instant &left = band.middle.left, &right = band.middle.right;
  const int first = std::min(left.first, right.first);
  const int knots = std::max(left.first, right.first) + Trajectory::kSupport - first;
  WindowBand local = band.middle;  // as if its first knot were the trajectory's
  local.left.first -= first;
  local.right.first -= first;
  using States = Eigen::Matrix<double, kObservationStates, kObservationStates>;
  Eigen::MatrixXd by_unknowns = Eigen::MatrixXd::Zero(kObservationStates, columnOf(knots));
  addByUnknowns(local, States::Identity(), by_unknowns);
  const Eigen::MatrixXd products = by_unknowns.transpose() * band.information * by_unknowns;
  const Eigen::VectorXd gradient = by_unknowns.transpose() * band.gradient;
  const Eigen::Index own = 6 * static_cast<Eigen::Index>(knots), at = columnOf(first);
  information_.topLeftCorner<kSharedStates, kSharedStates>() +=
      products.topLeftCorner<kSharedStates, kSharedStates>();
  information_.block(0, at, kSharedStates, own) += products.topRightCorner(kSharedStates, own);
  information_.block(at, 0, own, kSharedStates) += products.bottomLeftCorner(own, kSharedStates);
  information_.block(at, at, own, own) += products.bottomRightCorner(own, own);
  gradient_.head<kSharedStates>() += gradient.head<kSharedStates>();
  gradient_.segment(at, own) += gradient.tail(own);
}

/// Subtracts the Schur complement of the landmarks with these columns, which depend on the shared states and
/// on the unknowns `from` and later.
void WindowEquations::subtractEliminated(Eigen::Index begin, Eigen::Index end, Eigen::Index from) {
  const Eigen::Index rest = information_.rows() - from;
  const auto shared = couplings_.block(0, begin, kSharedStates, end - begin);
  const auto knots = couplings_.block(from, begin, rest, end - begin);
  information_.topLeftCorner<kSharedStates, kSharedStates>().noalias() -= shared * shared.transpose();
  information_.block(from, 0, rest, kSharedStates).noalias() -= knots * shared.transpose();
  information_.bottomRightCorner(rest, rest).selfadjointView<Eigen::Lower>().rankUpdate(knots, -1.0);
}

void WindowEquations::setLandmarks(const WindowProblem& problem, const std::vector<WindowLandmark>& landmarks,
                                   bool gated, double scale) {
  const Eigen::Index unknowns = columnOf(problem.trajectory.size());
  information_.setZero(unknowns, unknowns);
  gradient_.setZero(unknowns);
  sums_ = {};
  bands_.resize(problem.pairs.size() * kBands);
  for (Band& band : bands_)
    band.used = false;
  eliminated_.resize(landmarks.size());
  const Eigen::Index columns = 3 * static_cast<Eigen::Index>(landmarks.size());
  couplings_.setZero(unknowns, columns);
  gradients_.setZero(columns);
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    eliminated_[i] = eliminate(problem, landmarks[i], gated, scale, 3 * static_cast<Eigen::Index>(i));
  for (const Band& band : bands_)
    if (band.used) addBand(band);
  if (landmarks.empty()) return;
  // Landmarks that come with one pair follow each other.
  for (std::size_t begin = 0, end = 0; begin < landmarks.size(); begin = end) {
    const int pair = landmarks[begin].observations.front().pair;
    while (end < landmarks.size() && landmarks[end].observations.front().pair == pair)
      ++end;
    const double earliest = std::min({problem.leftTime(pair, -0.5), problem.leftTime(pair, 0.5),
                                      problem.rightTime(pair, -0.5), problem.rightTime(pair, 0.5)});
    subtractEliminated(3 * static_cast<Eigen::Index>(begin), 3 * static_cast<Eigen::Index>(end),
                       columnOf(problem.trajectory.at(earliest).first));
  }
  information_.triangularView<Eigen::StrictlyUpper>() = information_.transpose();
  gradient_.noalias() -= couplings_ * gradients_;
}

void WindowEquations::addJerk(const WindowProblem& problem, int end) {
  constexpr auto kFactors = Trajectory::kThirdDifference;
  const Trajectory& trajectory = problem.trajectory;
  const double cube = std::pow(trajectory.interval(), 3);
  const double by_translation = 1.0 / std::pow(problem.jerk.translation * cube, 2);
  const double by_rotation = 1.0 / std::pow(problem.jerk.rotation * cube, 2);
  for (int first = 0; first < std::min(end, trajectory.size() - 3); ++first) {
    const Vector6d differences = trajectory.thirdDifferences(first);
    const auto by_knot = trajectory.turnDifferencesByKnot(first);
    const double translation =
        by_translation * jerkWeight(by_translation * differences.head<3>().squaredNorm());
    const double rotation = by_rotation * jerkWeight(by_rotation * differences.tail<3>().squaredNorm());
    for (int i = 0; i < Trajectory::kSupport; ++i) {
      const Eigen::Index row = columnOf(first + i);
      gradient_.segment<3>(row) -= kFactors[i] * translation * differences.head<3>();
      gradient_.segment<3>(row + 3) -= rotation * by_knot[i].transpose() * differences.tail<3>();
      for (int j = 0; j < Trajectory::kSupport; ++j) {
        const Eigen::Index column = columnOf(first + j);
        information_.block<3, 3>(row, column).diagonal().array() += kFactors[i] * kFactors[j] * translation;
        information_.block<3, 3>(row + 3, column + 3) += rotation * by_knot[i].transpose() * by_knot[j];
      }
    }
  }
}

void WindowEquations::addPrior(const WindowProblem& problem) {
  const WindowPrior& prior = problem.prior;
  const Eigen::Index known = prior.information.rows();
  information_.topLeftCorner(known, known) += prior.information;
  gradient_.head(known) +=
      prior.vector - prior.information * prior.changeTo(problem.shared, problem.trajectory);
}

void WindowEquations::moveLandmarks(const Eigen::VectorXd& step,
                                    std::vector<WindowLandmark>& landmarks) const {
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eliminated& own = eliminated_[i];
    if (!own.used) continue;
    const Eigen::Index columns = 3 * static_cast<Eigen::Index>(i);
    const Eigen::Vector3d rest =
        gradients_.segment<3>(columns) - couplings_.middleCols<3>(columns).transpose() * step;
    landmarks[i].place += own.root.triangularView<Eigen::Lower>().transpose().solve(rest);
  }
}

}  // namespace cartvo::vo
