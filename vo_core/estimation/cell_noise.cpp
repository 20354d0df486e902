// Weights of image cells by their residuals.
#include "vo_core/estimation/cell_noise.hpp"

#include <algorithm>

namespace cartvo::vo {

CellNoise::CellNoise(double correlated_pairs, double outlier_stddevs)
    : pairs_(correlated_pairs), largest_square_(outlier_stddevs * outlier_stddevs) {
  weights_.fill(1.0);
}

double CellNoise::weightAt(const StereoCamera& camera, const Eigen::Vector2d& pixel) const {
  return weights_[cellOf(camera, pixel)];
}

void CellNoise::update(const BundleProblem& adjusted) {
  const double kept = 1.0 - 1.0 / pairs_;
  for (std::array<double, kCells>* sums : {&squares_, &counts_})
    for (double& sum : *sums)
      sum *= kept;
  const int newest = static_cast<int>(adjusted.poses.size()) - 1;
  std::array<int, kCells> landmarks{};
  int all = 0;
  for (const BundleLandmark& landmark : adjusted.landmarks) {
    const BundleObservation& last = landmark.observations.back();
    if (last.pose != newest) continue;
    const int cell = cellOf(adjusted.camera, last.left);
    squares_[cell] += std::min(landmark.error * landmark.error, largest_square_);
    counts_[cell] += 1.0;
    ++landmarks[cell];
    ++all;
  }
  double sum = 0.0;
  for (int cell = 0; cell < kCells; ++cell) {
    // The prior is one landmark of the expected residuals, seen in all remembered pairs.
    weights_[cell] = (counts_[cell] + pairs_) / (squares_[cell] + pairs_);
    sum += landmarks[cell] * weights_[cell];
  }
  if (all == 0) return;
  for (double& weight : weights_)
    weight *= all / sum;
}

}  // namespace cartvo::vo
