// Feeds the time offset estimated by the odometry back to the timestamps.

#include "pipeline/visual_offset_estimator.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::pipeline {
namespace {

constexpr double kMemory = 10.0;          // s: about that of the odometry's estimate of the delay
constexpr double kMaxStddev_ns = 3e6;     // an estimate with a larger one is worse than arrival times
constexpr double kStddevGrowth_ns = 1e4;  // per second without a new estimate
// Share by which the odometry may underestimate an offset; it grows with offsets beyond the linear range. The
// remaining offset shrinks as the estimate is applied to the timestamps.
constexpr double kUnderestimate = 0.1;
constexpr double kLinearRange_ns = 12e6;

}  // namespace

std::optional<capture::OffsetEstimate> VisualOffsetEstimator::update(
    const std::optional<vo::RigCalibrationError>& rig, double applied_correction_ns, double time_step) {
  const double elapsed = std::max(time_step, 1e-3);
  weight_ = weight_ * std::exp(-elapsed / kMemory) + elapsed;
  applied_correction_ns_ += elapsed / weight_ * (applied_correction_ns - applied_correction_ns_);
  if (estimate_) estimate_->stddev_ns += kStddevGrowth_ns * elapsed;
  if (!rig) return estimate_;
  const double delay_ns = 1e9 * rig->delay.value;
  const double noise_ns = 1e9 * rig->delay.stddev;
  const double bias_ns =
      kUnderestimate * std::abs(delay_ns) * std::max(1.0, std::abs(delay_ns) / kLinearRange_ns);
  const double stddev_ns = std::hypot(noise_ns, bias_ns);
  const bool better = estimate_ && stddev_ns < estimate_->stddev_ns;
  if (noise_ns < kMaxStddev_ns || better)
    estimate_ = capture::OffsetEstimate{applied_correction_ns_ + delay_ns, stddev_ns};
  return estimate_;
}

}  // namespace cartvo::pipeline
