#include "calib/sync_fault.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {
namespace {

Eigen::Vector2d meanOf(const std::vector<Eigen::Vector2d>& residuals) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& residual : residuals)
    sum += residual;
  return sum / static_cast<double>(std::max<std::size_t>(residuals.size(), 1));
}

}  // namespace

SyncDiagnosis diagnoseSync(const std::vector<ViewResiduals>& residuals, double corner_deviation) {
  constexpr double kSignificant = 4.0;   // deviations of the mean
  constexpr double kLeastShift = 0.25;   // px: below it does no harm
  constexpr double kOpposed = -0.8;      // the cosine between the two
  constexpr double kFaultyShare = 0.25;  // of the views
  SyncDiagnosis diagnosis;
  for (const ViewResiduals& view : residuals) {
    if (view.left.empty() || view.right.empty()) continue;
    const Eigen::Vector2d left = meanOf(view.left), right = meanOf(view.right);
    const double shift = (left - right).norm();
    const double fewest = static_cast<double>(std::min(view.left.size(), view.right.size()));
    const double chance = kSignificant * corner_deviation * std::sqrt(2.0 / fewest);
    if (shift < std::max(chance, kLeastShift)) continue;
    if (left.dot(right) > kOpposed * left.norm() * right.norm()) continue;
    ++diagnosis.opposed_views;
    diagnosis.largest_shift = std::max(diagnosis.largest_shift, shift);
  }
  diagnosis.is_fault = diagnosis.opposed_views > kFaultyShare * static_cast<double>(residuals.size());
  return diagnosis;
}

}  // namespace cartvo
