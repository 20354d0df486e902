// Comparison of measured frame rates and readouts with the stated ones.

#include "daemon/diagnostics/measurement_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace cartvo::daemon {
namespace {

constexpr double kTolerance = 1.1;  // ratio of two periods

bool differ(double a, double b) {
  return std::max(a, b) > kTolerance * std::min(a, b);
}

}  // namespace

std::string frameRateProblem(const pipeline::FramePeriods& periods, std::optional<double> configured) {
  const std::array<std::int64_t, 2>& exposures = periods.by_exposures;
  const std::array<std::int64_t, 2>& arrivals = periods.by_arrivals;
  if (std::min({exposures[0], exposures[1], arrivals[0], arrivals[1]}) <= 0) return {};
  const auto is_not = [](const std::array<std::int64_t, 2>& of, double period) {
    return differ(static_cast<double>(of[0]), period);
  };
  const double left = 1e9 / static_cast<double>(arrivals[0]);
  const double right = 1e9 / static_cast<double>(arrivals[1]);
  if (is_not(exposures, static_cast<double>(exposures[1])) &&
      is_not(arrivals, static_cast<double>(arrivals[1]))) {
    return fmt::format(
        "the left camera sends {:.1f} pictures a second, the right one {:.1f}: set both to the same frame "
        "rate",
        left, right);
  }
  if (!configured || !is_not(exposures, 1e9 / *configured) || !is_not(arrivals, 1e9 / *configured)) return {};
  return fmt::format(
      "the cameras send {:.1f} pictures a second, cameras.frame_rate says {:g}: correct it or the cameras, "
      "or leave "
      "it out (the measured rate is used)",
      left, *configured);
}

namespace {

constexpr double kMinDifference = 0.5e-3;  // s; less changes the motion by less than the pictures' noise does
constexpr double kMinSignificance = 3.0;   // standard deviations
constexpr double kHysteresis = 0.7;        // a reported difference ends below this fraction of its limit
constexpr double kModeRatio = 1.2;         // of the readouts of a sensor's modes for 50 Hz and 60 Hz
constexpr double kModeRatioTolerance = 0.05;

bool isFaulty(double difference, double stddev, bool was_faulty) {
  const double size = std::abs(difference);
  return size > (was_faulty ? kHysteresis : 1.0) * kMinDifference && size > kMinSignificance * stddev;
}

}  // namespace

bool ReadoutCheck::update(const vo::ReadoutEstimates& estimates) {
  latest_ = estimates;
  const std::array<bool, 3> before = faulty_;
  const std::array<vo::EstimateWithStddev, 2> cameras{estimates.left, estimates.right};
  for (std::size_t i = 0; i < cameras.size(); ++i)
    faulty_[i] = stated_[i] && isFaulty(cameras[i].value - *stated_[i], cameras[i].stddev, before[i]);
  // The directions may differ: a camera may be mounted upside down.
  const double difference = std::abs(estimates.left.value) - std::abs(estimates.right.value);
  const double stddev = std::hypot(estimates.left.stddev, estimates.right.stddev);
  faulty_[2] = !(stated_[0] && stated_[1]) && isFaulty(difference, stddev, before[2]);
  return faulty_ != before;
}

std::string ReadoutCheck::message() const {
  if (!latest_) return {};
  const std::array<vo::EstimateWithStddev, 2> cameras{latest_->left, latest_->right};
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    if (!faulty_[i]) continue;
    return fmt::format(
        "the {} camera's readout is {:.1f} ± {:.1f} ms, not {:.1f} ms as the rig says: measure it with "
        "'cartvo "
        "calibrate readout'",
        i == 0 ? "left" : "right", 1e3 * cameras[i].value, 1e3 * cameras[i].stddev, 1e3 * *stated_[i]);
  }
  if (!faulty_[2]) return {};
  const double left = std::abs(latest_->left.value), right = std::abs(latest_->right.value);
  const double ratio = std::max(left, right) / std::min(left, right);
  if (std::abs(ratio - kModeRatio) < kModeRatioTolerance)
    return fmt::format(
        "the cameras' line frequency settings differ (50 Hz / 60 Hz): readouts of {:.1f} ms left and {:.1f} "
        "ms "
        "right; set both alike",
        1e3 * latest_->left.value, 1e3 * latest_->right.value);
  return fmt::format(
      "the cameras' readouts differ: {:.1f} ms left and {:.1f} ms right; are both of one model, with the "
      "same "
      "settings?",
      1e3 * latest_->left.value, 1e3 * latest_->right.value);
}

}  // namespace cartvo::daemon
