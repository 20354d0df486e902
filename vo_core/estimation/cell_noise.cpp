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
  for (ResidualVariance& cell : residuals_)
    cell.fade(pairs_);
  const int newest = static_cast<int>(adjusted.poses.size()) - 1;
  std::array<int, kCells> landmarks{};
  int all = 0;
  for (const BundleLandmark& landmark : adjusted.landmarks) {
    const BundleObservation& last = landmark.observations.back();
    if (last.pose != newest) continue;
    const int cell = cellOf(adjusted.camera, last.left);
    residuals_[cell].add(std::min(landmark.error * landmark.error, largest_square_));
    ++landmarks[cell];
    ++all;
  }
  double sum = 0.0;
  for (int cell = 0; cell < kCells; ++cell) {
    weights_[cell] = residuals_[cell].weight(pairs_);
    sum += landmarks[cell] * weights_[cell];
  }
  if (all == 0) return;
  for (double& weight : weights_)
    weight *= all / sum;
}

}  // namespace cartvo::vo
