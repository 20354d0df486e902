#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace cartvo::world {

/// Positions of rays within pixels: stratified in each pixel and different from pixel to pixel and frame to
/// frame, so that the remaining sampling error looks like grain and not like a fixed grid.
class SamplePatterns {
 public:
  static constexpr int kMaxPixelSamples = 16;  ///< samples per pixel

  SamplePatterns();

  /// `samples` offsets from the pixel's centre, px, in [-0.5, 0.5). `samples`: 1, 2, 4, 8 or 16.
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
