#pragma once

#include <cstdint>
#include <random>

namespace cartvo::vo {

/// Generates uniform random numbers for RANSAC subsets, the same on each platform.
class SubsetRandom {
 public:
  explicit SubsetRandom(std::uint64_t seed) : engine_(seed) {}
  /// In [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace cartvo::vo
