#pragma once

#include <cstdint>
#include <string>

namespace cartvo::daemon {

/// Names of the bits in odometry_t.reasons, for example "too few matches, high residual".
std::string reasonNames(std::int32_t reasons);

}  // namespace cartvo::daemon
