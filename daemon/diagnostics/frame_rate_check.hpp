#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace cartvo::daemon {

/// The problem of the cameras' frame rates, as measured (frame periods of the left and the right camera,
/// ns; 0: unknown): they differ from each other or from the configured rate (Hz) by a tenth or more. Empty if
/// there is none.
std::string frameRateProblem(const std::array<std::int64_t, 2>& periods_ns, std::optional<double> configured);

}  // namespace cartvo::daemon
