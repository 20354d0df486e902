// Normal equations of a window.
#include "vo_core/window/window_equations.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

namespace cartvo::vo {
namespace {

constexpr double kGate = 6.0;              // mean square of a landmark's residuals over their scales
constexpr double kLargestSquare = 60.0;    // of an image in that mean
constexpr double kLeastInformation = 1.0;  // m^2, of an inverse depth that nothing shows
constexpr double kLeastFreedom = 100.0;    // of residuals from which a scale is estimated
constexpr double kLeastScale = 0.01, kLargestScale = 1.0;  // px
constexpr double kLargestCommon = 0.9;                     // see WindowNoise::common
constexpr double kLargestCommonSquare = 16.0;              // of residuals that it is estimated from
constexpr double kSquareBehindCamera = 1e6;
constexpr int kBands = 41;  // of rows, between which the camera accelerates uniformly

/// Instant of the middle of a band, as a share of the readout.
double shareOf(std::size_t band) {
  return (static_cast<double>(band % kBands) + 0.5) / kBands - 0.5;
}

Eigen::LDLT<Eigen::MatrixXd> factorOf(Eigen::MatrixXd information) {
  constexpr double kLeast = 1e-6;  // 1/m^2 and 1/rad^2, of knots that nothing is known of
  information.diagonal().tail(information.rows() - kSharedStates).array() += kLeast;
  return information.ldlt();
}

/// Information of a shared state with all others unknown.
double marginalInformation(const Eigen::LDLT<Eigen::MatrixXd>& factor, int state) {
  return 1.0 / factor.solve(Eigen::VectorXd::Unit(factor.rows(), state))[state];
}

/// Index of the band of rows of a pair.
std::size_t bandIndexOf(const WindowObservation& observation) {
  const int row = std::clamp(static_cast<int>((observation.left_share + 0.5) * kBands), 0, kBands - 1);
  return static_cast<std::size_t>(observation.pair) * kBands + static_cast<std::size_t>(row);
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
        precision * (equations.residual()[row] * equations.residual()[row + 2] + explained(row, row + 2));
    sums.by_left += precision * (equations.residual()[row] * equations.residual()[row] + explained(row, row));
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
  const std::size_t at = bandIndexOf(observation);
  Band& band = bands_[at];
  if (band.used) return band;
  band.used = true;
  const double share = shareOf(at);
  band.middle.left_time = problem.leftTime(observation.pair, share);
  band.middle.right_time = problem.rightTime(observation.pair, share);
  band.middle.left = problem.trajectory.at(band.middle.left_time);
  band.middle.right = problem.trajectory.at(band.middle.right_time);
  band.sums.reset(band.middle);
  return band;
}

/// Adds a landmark's observations to the equations of their bands, and eliminates it.
WindowEquations::Eliminated WindowEquations::eliminate(const WindowProblem& problem,
                                                       const WindowLandmark& landmark, bool gated,
                                                       double scale, WindowNoiseSums* noise) {
  Eliminated result;
  std::array<ObservationEquations, kMaximumWindowPairs> rows;
  std::array<Band*, kMaximumWindowPairs> bands;
  double squares = 0.0, freedom = -3.0;
  const std::size_t count = landmark.observations.size();
  for (std::size_t i = 0; i < count; ++i) {
    const WindowObservation& observation = landmark.observations[i];
    bands[i] = &bandOf(problem, observation);
    if (!setEquations(problem, bands[i]->middle, landmark, observation, scale, rows[i])) {
      result.fit.square = kSquareBehindCamera;
      return result;
    }
    for (int image = 0; image < (observation.stereo ? 2 : 1); ++image) {
      squares += std::min(rows[i].squareIn(image), kLargestSquare);
      freedom += 2.0;
    }
  }
  const ObservationEquations& newest = rows[count - 1];
  result.fit.right_row = newest.residual()[3];
  result.fit.square = landmark.observations.back().stereo ? 0.25 * (newest.squareIn(0) + newest.squareIn(1))
                                                          : 0.5 * newest.squareIn(0);
  if (freedom < 0.0 || (gated && squares > kGate * std::max(freedom, 1.0))) return result;

  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information(2, 2) = kLeastInformation;
  for (std::size_t i = 0; i < count; ++i) {
    const ObservationEquations& row = rows[i];
    Eigen::Vector4d weight = kStudentInformation * row.precision;
    weight.head<2>() *= studentWeight(row.squareIn(0));
    weight.tail<2>() *= studentWeight(row.squareIn(1));
    information += row.by_place.transpose().lazyProduct(weight.asDiagonal() * row.by_place);
    sums_.add(row, weight, bands[i]->sums);
  }
  const Eigen::LLT<Eigen::Matrix3d> factor(information);
  result.used = factor.info() == Eigen::Success;
  result.root_inverse.setZero();
  if (result.used) {
    result.root_inverse = factor.matrixL().solve(Eigen::Matrix3d::Identity());
    result.fit.information = 1.0 / (result.root_inverse(2, 2) * result.root_inverse(2, 2));
  }
  result.index = sums_.eliminate(result.root_inverse);
  if (!result.used || !noise) return result;
  const Eigen::Matrix3d covariance = result.root_inverse.transpose().lazyProduct(result.root_inverse);
  for (std::size_t i = 0; i < count; ++i)
    noise->add(landmark.level, rows[i], covariance);
  return result;
}

void WindowEquations::setLandmarks(const WindowProblem& problem, const std::vector<WindowLandmark>& landmarks,
                                   bool gated, double scale, WindowNoiseSums* noise) {
  sums_.reset(problem.trajectory.size(), landmarks.size());
  bands_.resize(problem.pairs.size() * kBands);
  for (Band& band : bands_)
    band.used = false;
  eliminated_.resize(landmarks.size());
  // Landmarks in the same bands follow each other, so that these stay in the cache.
  by_band_.sort(bands_.size(), landmarks.size(),
                [&](std::size_t i) { return bandIndexOf(landmarks[i].observations.front()); });
  for (int place = 0; place < by_band_.begin(bands_.size()); ++place) {
    const auto i = static_cast<std::size_t>(by_band_[place]);
    eliminated_[i] = eliminate(problem, landmarks[i], gated, scale, noise);
  }
  for (const Band& band : bands_)
    if (band.used) sums_.add(band.sums);
  pretended_.setZero();
  for (std::size_t at = 0; at < bands_.size(); ++at)
    if (bands_[at].used) addPretended(at, problem.pairs[static_cast<int>(at / kBands)].twist_covariance);
  sums_.subtractEliminated();
  sums_.copyTo(information_, gradient_);
}

/// Adds what a band pretends, by the covariance of its pair's twist.
void WindowEquations::addPretended(std::size_t band, const Matrix6d& covariance) {
  const BandSums& sums = bands_[band].sums;
  const auto information = [&](int position, int turn) {
    const auto state = [&](int i) { return i < 3 ? position + i : turn + i - 3; };
    double trace = 0.0;
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        trace += covariance(i, j) * sums(state(i), state(j));
    return trace;
  };
  const double square = shareOf(band) * shareOf(band);
  const double by_right = information(kRowRightPosition, kRowRightTurn);
  pretended_ +=
      Eigen::Vector3d(square * information(kRowLeftPosition, kRowLeftTurn), square * by_right, by_right);
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

void WindowEquations::discountTimes(const WindowPrior& prior) {
  constexpr double kNegligible = 0.01;  // share of what is known
  std::optional<Eigen::LDLT<Eigen::MatrixXd>> factor_of_prior;
  for (const int state : {kLeftReadout, kRightReadout, kOffset}) {
    const double pretended = pretended_[state], own = information_(state, state);
    if (!(pretended > 0.0 && own > 0.0) || own < kNegligible * kNegligible * prior.information(state, state))
      continue;
    if (!factor_of_prior) factor_of_prior = factorOf(prior.information);
    const double known = marginalInformation(*factor_of_prior, state);
    if (pretended < kNegligible * known) continue;
    const double gain = marginalInformation(factorOf(prior.information + information_), state) - known;
    const double left = gain - pretended;
    const double factor = 1.0 / (left > 0.0 ? own + gain * left / pretended : own);
    const Eigen::VectorXd column = information_.col(state);
    gradient_ -= factor * gradient_[state] * column;
    information_.noalias() -= factor * column * column.transpose();
  }
}

void WindowEquations::addPrior(const WindowProblem& problem) {
  const WindowPrior& prior = problem.prior;
  const Eigen::Index known = prior.information.rows();
  information_.topLeftCorner(known, known) += prior.information;
  gradient_.head(known) +=
      prior.vector - prior.information * prior.changeTo(problem.shared, problem.trajectory);
}

void WindowEquations::moveLandmarks(const Eigen::VectorXd& step, std::vector<WindowLandmark>& landmarks) {
  sums_.setStep(step);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Eliminated& own = eliminated_[i];
    if (own.used) landmarks[i].place += own.root_inverse.transpose().lazyProduct(sums_.stepOf(own.index));
  }
}

}  // namespace cartvo::vo
