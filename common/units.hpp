#pragma once

#include <numbers>

namespace cartvo {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

}  // namespace cartvo
