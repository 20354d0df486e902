#pragma once

#include <cstdint>

namespace cartvo {

/// How the motion is estimated.
enum class Estimator : std::uint8_t {
  thesis,  ///< Horn's absolute orientation on weighted 3D-3D pairs (thesis 4.15, 4.16)
};

struct OdometrySettings {
  Estimator estimator = Estimator::thesis;
  int features = 1000;     ///< aimed at in each left image
  std::uint64_t seed = 1;  ///< of the random subsets
};

}  // namespace cartvo
