#pragma once

#include <cstdint>
#include <string>

namespace cartvo {

/// The reasons of an INVALID odometry_t in words: "too few matches, high residual".
std::string reasonNames(std::int32_t reasons);

}  // namespace cartvo
