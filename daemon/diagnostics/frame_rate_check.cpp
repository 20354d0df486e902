// Comparison of the cameras' frame rates.

#include "daemon/diagnostics/frame_rate_check.hpp"

#include <algorithm>
#include <array>
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

}  // namespace cartvo::daemon
