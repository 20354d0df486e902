// Detection of boards that moved between the exposures of the two cameras.
#include "calib/solver/sync_fault.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::calib {
namespace {

Eigen::Vector2d meanOf(const std::vector<Eigen::Vector2d>& residuals) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& residual : residuals)
    sum += residual;
  return sum / static_cast<double>(std::max<std::size_t>(residuals.size(), 1));
}

}  // namespace

SyncDiagnosis diagnoseSync(const std::vector<ViewResiduals>& residuals, double corner_stddev) {
  constexpr double kGate = 4.0;              // standard deviations of the mean
  constexpr double kMinShift = 0.25;         // px: a smaller shift is harmless
  constexpr double kMaxCosine = -0.8;        // between the mean left and right residual
  constexpr double kMaxOpposedShare = 0.25;  // of the views
  SyncDiagnosis diagnosis;
  for (const ViewResiduals& view : residuals) {
    if (view.left.empty() || view.right.empty()) continue;
    const Eigen::Vector2d left = meanOf(view.left), right = meanOf(view.right);
    const double shift = (left - right).norm();
    const double corners = static_cast<double>(std::min(view.left.size(), view.right.size()));
    const double gate = kGate * corner_stddev * std::sqrt(2.0 / corners);
    if (shift < std::max(gate, kMinShift)) continue;
    if (left.dot(right) > kMaxCosine * left.norm() * right.norm()) continue;
    ++diagnosis.opposed_views;
    diagnosis.max_shift = std::max(diagnosis.max_shift, shift);
  }
  diagnosis.is_fault = diagnosis.opposed_views > kMaxOpposedShare * static_cast<double>(residuals.size());
  return diagnosis;
}

}  // namespace cartvo::calib
