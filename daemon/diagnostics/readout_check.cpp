// Compares the estimated readouts of both cameras with the rig and with each other.
#include "daemon/diagnostics/readout_check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace cartvo::daemon {
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
