// Weights of features from their motion history.
#include "vo_core/thesis/feature_history.hpp"

#include <Eigen/LU>

namespace cartvo::vo {
namespace {

double normalisedSquare(const WorldStep& step) {
  return step.displacement.dot(step.covariance.inverse() * step.displacement) / 3.0;
}

}  // namespace

double motionVariance(const WorldStep& earlier, const WorldStep& later) {
  return 0.5 * (normalisedSquare(earlier) + normalisedSquare(later));
}

double historyWeight(double weight, double motion_variance, const HistorySettings& settings) {
  const double now =
      1.0 / (1.0 + motion_variance / (settings.half_weight_stddevs * settings.half_weight_stddevs));
  return 0.5 * (weight + now);
}

}  // namespace cartvo::vo
