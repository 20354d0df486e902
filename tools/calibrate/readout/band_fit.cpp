// Least-squares fit of moving bands to row profiles.
#include "tools/calibrate/readout/band_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/statistics.hpp"

namespace cartvo::calibrate {
namespace {

using Complex = std::complex<double>;
constexpr double kTwoPi = 6.283185307179586;
constexpr double kMinGrey = 4.0;  ///< darker rows do not show the lamp
constexpr double kMinBands = 0.5, kMaxBands = 25.0, kBandStep = 0.05;
constexpr double kOutlier = 3.0;  ///< times the median residual of a block
constexpr int kIterations = 4;
constexpr int kGroups = 8;  ///< of pictures, each left out once for the standard deviation

/// Removes mean and linear trend over the rows from each column: they are the picture's brightness.
void removeTrend(const Eigen::VectorXd& shares, Eigen::MatrixXd& columns) {
  columns.rowwise() -= columns.colwise().mean().eval();
  const Eigen::RowVectorXd slopes = shares.transpose() * columns / shares.squaredNorm();
  columns -= shares * slopes;
}

/// Cosine and sine with this number of bands, without mean and trend.
Eigen::MatrixXd bandBasis(const Eigen::VectorXd& shares, double bands) {
  Eigen::MatrixXd basis(shares.size(), 2);
  basis.col(0) = (kTwoPi * bands * shares.array()).cos();
  basis.col(1) = (kTwoPi * bands * shares.array()).sin();
  removeTrend(shares, basis);
  return basis;
}

}  // namespace

BandFit::BandFit(const std::vector<RowProfile>& profiles)
    : rows_(profiles.front().means.rows()), pictures_(static_cast<Eigen::Index>(profiles.size())) {
  shares_ = (Eigen::VectorXd::LinSpaced(rows_, 0.5, static_cast<double>(rows_) - 0.5).array() /
                 static_cast<double>(rows_) -
             0.5)
                .matrix();
  const std::vector<Eigen::MatrixXd> level_signals = normalise(profiles);
  searchBands(level_signals);
  measureAdvances(profiles, level_signals);
}

std::vector<Eigen::MatrixXd> BandFit::normalise(const std::vector<RowProfile>& profiles) {
  std::vector<Eigen::MatrixXd> level_signals;
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(rows_, profiles.front().means.cols());
  for (const RowProfile& profile : profiles)
    mean += profile.means / static_cast<double>(pictures_);
  mean = mean.cwiseMax(kMinGrey);
  weights_.resize(mean.cols(), pictures_);
  for (Eigen::Index block = 0; block < mean.cols(); ++block) {
    Eigen::MatrixXd signal(rows_, pictures_);
    for (Eigen::Index k = 0; k < pictures_; ++k)
      signal.col(k) =
          profiles[static_cast<std::size_t>(k)].means.col(block).cwiseQuotient(mean.col(block)).array() - 1.0;
    signals_.push_back(signal);
    removeTrend(shares_, signal);
    std::vector<double> powers;
    for (Eigen::Index k = 0; k < pictures_; ++k)
      powers.push_back(signal.col(k).squaredNorm() / static_cast<double>(rows_));
    const double power = medianOf(powers);
    for (Eigen::Index k = 0; k < pictures_; ++k) {
      const bool is_usable = power > 0.0 && powers[static_cast<std::size_t>(k)] < kOutlier * kOutlier * power;
      weights_(block, k) = is_usable ? 1.0 / power : 0.0;
    }
    level_signals.push_back(std::move(signal));
  }
  return level_signals;
}

void BandFit::searchBands(const std::vector<Eigen::MatrixXd>& level_signals) {
  double most = -1.0;
  for (double bands = kMinBands; bands <= kMaxBands; bands += kBandStep) {
    const Eigen::MatrixXd basis = bandBasis(shares_, bands);
    const Eigen::Matrix2d normal = basis.transpose() * basis;
    const Eigen::LLT<Eigen::Matrix2d> solver(normal);
    double power = 0.0;
    for (std::size_t block = 0; block < level_signals.size(); ++block) {
      const Eigen::MatrixXd projected = basis.transpose() * level_signals[block];
      const Eigen::RowVectorXd explained = projected.cwiseProduct(solver.solve(projected)).colwise().sum();
      power += explained.dot(weights_.row(static_cast<Eigen::Index>(block)));
    }
    if (power <= most) continue;
    most = power;
    bands_ = bands;
  }
}

void BandFit::measureAdvances(const std::vector<RowProfile>& profiles,
                              const std::vector<Eigen::MatrixXd>& level_signals) {
  const Eigen::MatrixXd basis = bandBasis(shares_, bands_);
  const Eigen::Matrix2d inverse = (basis.transpose() * basis).inverse();
  std::vector<Eigen::VectorXcd> phasors;  // per block
  for (const Eigen::MatrixXd& signal : level_signals) {
    const Eigen::MatrixXd solution = inverse * (basis.transpose() * signal);
    Eigen::VectorXcd block_phasors(pictures_);
    for (Eigen::Index k = 0; k < pictures_; ++k)
      block_phasors[k] = Complex(solution(0, k), -solution(1, k));
    phasors.push_back(block_phasors);
  }
  phases_ = Eigen::VectorXd::Zero(pictures_);
  for (Eigen::Index k = 1; k < pictures_; ++k) {
    Complex product = 0.0;
    for (std::size_t block = 0; block < phasors.size(); ++block) {
      const auto b = static_cast<Eigen::Index>(block);
      product +=
          std::min(weights_(b, k), weights_(b, k - 1)) * phasors[block][k] * std::conj(phasors[block][k - 1]);
    }
    advances_.push_back(
        {profiles[static_cast<std::size_t>(k)].time - profiles[static_cast<std::size_t>(k - 1)].time,
         product});
    phases_[k] = phases_[k - 1] + std::arg(product);
  }
}

void BandFit::fitRows(Eigen::Index excluded_begin, Eigen::Index excluded_end) {
  A_.clear();
  Eigen::MatrixXd basis(pictures_, 2);
  basis.col(0) = phases_.array().cos();
  basis.col(1) = -phases_.array().sin();
  for (std::size_t block = 0; block < signals_.size(); ++block) {
    Eigen::VectorXd weights = weights_.row(static_cast<Eigen::Index>(block)).transpose();
    weights.segment(excluded_begin, excluded_end - excluded_begin).setZero();
    const Eigen::MatrixXd weighted = weights.asDiagonal() * basis;
    Eigen::Matrix2d normal = basis.transpose() * weighted;
    normal.diagonal().array() += 1e-9 + 1e-9 * normal.trace();
    const Eigen::MatrixXd solution = signals_[block] * weighted * normal.inverse();
    Eigen::VectorXcd A(rows_);
    for (Eigen::Index row = 0; row < rows_; ++row)
      A[row] = Complex(solution(row, 0), solution(row, 1));
    A_.push_back(A);
  }
}

void BandFit::fitPhases() {
  for (Eigen::Index k = 0; k < pictures_; ++k) {
    Eigen::Matrix2d normal = 1e-12 * Eigen::Matrix2d::Identity();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (std::size_t block = 0; block < signals_.size(); ++block) {
      Eigen::MatrixXd basis(rows_, 2);
      basis.col(0) = A_[block].real();
      basis.col(1) = -A_[block].imag();
      const double weight = weights_(static_cast<Eigen::Index>(block), k);
      normal += weight * basis.transpose() * basis;
      right += weight * basis.transpose() * signals_[block].col(k);
    }
    const Eigen::Vector2d phase = normal.inverse() * right;
    if (phase.norm() > 0.0) phases_[k] = std::atan2(phase.y(), phase.x());
  }
}

void BandFit::updateWeights() {
  for (std::size_t block = 0; block < signals_.size(); ++block) {
    std::vector<double> residuals;
    for (Eigen::Index k = 0; k < pictures_; ++k) {
      const Eigen::VectorXd predicted = (A_[block] * std::polar(1.0, phases_[k])).real();
      residuals.push_back((signals_[block].col(k) - predicted).norm() / std::sqrt(double(rows_)));
    }
    const double typical = std::max(medianOf(residuals), 1e-6);
    for (Eigen::Index k = 0; k < pictures_; ++k) {
      const bool is_usable = residuals[static_cast<std::size_t>(k)] < kOutlier * typical;
      weights_(static_cast<Eigen::Index>(block), k) = is_usable ? 1.0 / (typical * typical) : 0.0;
    }
  }
}

void BandFit::fitSlopes(double bands, Eigen::VectorXd& slopes, Eigen::VectorXd& information) const {
  slopes = information = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(A_.size()));
  Eigen::VectorXcd turned_back(rows_);
  for (Eigen::Index row = 0; row < rows_; ++row)
    turned_back[row] = std::polar(1.0, -kTwoPi * bands * shares_[row]);
  for (std::size_t block = 0; block < A_.size(); ++block) {
    const Eigen::VectorXcd turned = A_[block].cwiseProduct(turned_back);
    const Complex sum = turned.sum();
    if (std::abs(sum) == 0.0) continue;
    const Eigen::VectorXcd residual = turned * (std::conj(sum) / std::abs(sum));
    const Eigen::VectorXd power = residual.cwiseAbs2();
    const double mean_share = power.dot(shares_) / power.sum();
    const Eigen::VectorXd shares = shares_.array() - mean_share;
    const double spread = power.dot(shares.cwiseAbs2());
    const double moment = shares.dot(residual.cwiseAbs().cwiseProduct(Eigen::VectorXd(residual.imag())));
    const auto b = static_cast<Eigen::Index>(block);
    if (spread > 0.0) slopes[b] = moment / spread / kTwoPi;
    information[b] = spread * weights_.row(b).sum();
  }
}

double BandFit::bandsFromRows() const {
  constexpr int kSteps = 6;
  double bands = bands_;
  Eigen::VectorXd slopes, information;
  for (int step = 0; step < kSteps; ++step) {
    fitSlopes(bands, slopes, information);
    if (!(information.sum() > 0.0)) break;
    bands += slopes.dot(information) / information.sum();
  }
  return bands;
}

double BandFit::blockScatter(double bands) const {
  Eigen::VectorXd slopes, information;
  fitSlopes(bands, slopes, information);
  const double sum = information.sum();
  if (!(sum > 0.0)) return kMaxBands;
  return information.cwiseProduct(slopes).norm() / sum;
}

Estimate BandFit::refine() {
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    fitRows(0, 0);
    updateWeights();
    fitPhases();
  }
  std::vector<double> without_group;
  for (int group = 0; group < kGroups; ++group) {
    fitRows(pictures_ * group / kGroups, pictures_ * (group + 1) / kGroups);
    without_group.push_back(bandsFromRows());
  }
  fitRows(0, 0);
  bands_ = bandsFromRows();
  double sum = 0.0;
  for (const double bands : without_group)
    sum += (bands - bands_) * (bands - bands_);
  const double over_pictures = std::sqrt(sum * (kGroups - 1) / kGroups);  // jackknife
  return {bands_, std::hypot(over_pictures, blockScatter(bands_))};
}

double BandFit::amplitude() const {
  double power = 0.0;
  for (const Eigen::VectorXcd& A : A_)
    power += A.squaredNorm() / static_cast<double>(rows_) / static_cast<double>(A_.size());
  return std::sqrt(power);
}

}  // namespace cartvo::calibrate
