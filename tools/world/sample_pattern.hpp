#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace cartvo::world {

/// Where rays pass through pixels: stratified in each pixel, unlike from pixel to pixel and frame to frame,
/// so that what sampling leaves undone looks like fine grain and not like a grid that stands still before the
/// scene.
class SamplePatterns {
 public:
  static constexpr int kMost = 16;  ///< samples in one pixel

  SamplePatterns();

  /// Offsets from the pixel's centre, [-0.5, 0.5). `samples`: 1, 2, 4, 8 or 16.
  const Eigen::Vector2f* offsets(int samples, std::uint32_t pixel_hash) const {
    return &patterns_[level(samples)][static_cast<std::size_t>(pixel_hash % kVariants) * samples];
  }

 private:
  static constexpr int kVariants = 256;
  static std::size_t level(int samples) {
    std::size_t level = 0;
    while ((1 << level) < samples)
      ++level;
    return level;
  }

  std::array<std::vector<Eigen::Vector2f>, 5> patterns_;
};

}  // namespace cartvo::world
