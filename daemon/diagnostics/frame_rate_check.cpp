// Comparison of the cameras' frame rates.

#include "daemon/diagnostics/frame_rate_check.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace cartvo::daemon {
namespace {

constexpr double kTolerance = 1.1;  // ratio of two rates

bool differ(double a, double b) {
  return std::max(a, b) > kTolerance * std::min(a, b);
}

}  // namespace

std::string frameRateProblem(const std::array<std::int64_t, 2>& periods_ns,
                             std::optional<double> configured) {
  if (periods_ns[0] <= 0 || periods_ns[1] <= 0) return {};
  const double left = 1e9 / static_cast<double>(periods_ns[0]);
  const double right = 1e9 / static_cast<double>(periods_ns[1]);
  if (differ(left, right)) {
    return fmt::format(
        "the left camera sends {:.1f} pictures a second, the right one {:.1f}: set both to the same frame "
        "rate",
        left, right);
  }
  if (!configured || !differ(left, *configured)) return {};
  return fmt::format(
      "the cameras send {:.1f} pictures a second, cameras.frame_rate says {:g}: correct it or the cameras, "
      "or leave "
      "it out (the measured rate is used)",
      left, *configured);
}

}  // namespace cartvo::daemon
