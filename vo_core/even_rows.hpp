#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "vo_core/image_pyramid.hpp"
#include "vo_core/patch_lanes.hpp"

namespace cartvo {

/// The rows of pixels around a place, all of which lie equally far from whole ones.
template <typename Processor>
class EvenRows {
 public:
  using Lanes = PatchLanes<Processor>;

  /// Column and row 0 lie so many pixels left of and above `centre`, px of the level, inside it.
  EvenRows(const PyramidLevel& level, const Eigen::Vector2d& centre, int left, int above)
      : stride_(level.stride()) {
    const int x = static_cast<int>(centre.x()), y = static_cast<int>(centre.y());
    const PixelShares shares{static_cast<int>((kAcross + 1) * (centre.x() - x)),
                             static_cast<int>((kDown + 1) * (centre.y() - y))};
    Lanes::share(shares, shares_);
    first_ = level.at(x - left, y - above);
  }

  void load(int row) { Lanes::load(first_ + row * stride_, stride_, rows_); }
  /// Of the row that was loaded kLanes pixels from `Column` on, as PatchLanes::blend().
  template <int Column>
  void sample(IntLanes& sum) const {
    Lanes::template blend<Column>(rows_, shares_, sum);
  }

 private:
  std::ptrdiff_t stride_;
  const std::uint8_t* first_;
  typename Lanes::Shares shares_;
  typename Lanes::RowPair rows_;
};

}  // namespace cartvo
