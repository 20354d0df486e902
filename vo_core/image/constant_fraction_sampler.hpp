#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/image/patch_lanes.hpp"

namespace cartvo::vo {

/// Samples rows of pixels around a position, all at the same sub-pixel fraction, with constant interpolation
/// weights.
class ConstantFractionSampler {
 public:
  using Lanes = PatchLanes;

  /// Column 0 lies `left` px left of `centre` (px of the level, inside it), row 0 `above` px above it.
  ConstantFractionSampler(const PyramidLevel& level, const Eigen::Vector2d& centre, int left, int above)
      : stride_(level.stride()) {
    const int x = static_cast<int>(centre.x()), y = static_cast<int>(centre.y());
    const PixelFraction fraction{static_cast<int>((kColumnSteps + 1) * (centre.x() - x)),
                                 static_cast<int>((kRowSteps + 1) * (centre.y() - y))};
    Lanes::setWeights(fraction, weights_);
    first_ = level.at(x - left, y - above);
  }

  void load(int row) { Lanes::load(first_ + row * stride_, stride_, rows_); }
  /// Interpolates kLanes pixels of the loaded row from `Column` on, as PatchLanes::blend().
  template <int Column>
  void sample(IntLanes& sum) const {
    Lanes::template blend<Column>(rows_, weights_, sum);
  }

 private:
  std::ptrdiff_t stride_;
  const std::uint8_t* first_;
  typename Lanes::Weights weights_;
  typename Lanes::RowPair rows_;
};

}  // namespace cartvo::vo
