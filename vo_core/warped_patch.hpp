#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstdlib>

#include "vo_core/patch.hpp"
#include "vo_core/quads.hpp"

namespace cartvo {

/// The rows of a window around `position`, which must lie inside the level, under a warp from offsets in the
/// window to offsets in the level. All integers: places in 1/65536 px, from which pixels are interpolated by
/// 1/256 px, exactly.
template <typename Processor, int Side, int RowStep>
class WarpedRows {
 public:
  static constexpr float kUnit = 1.0F / 65536.0F;  ///< of what is sampled, in grey values

  /// No element of the warp may reach more than the level's border, nor turn columns around.
  WarpedRows(const PyramidLevel& level, const Eigen::Vector2d& position, const Eigen::Matrix2d& warp)
      : stride_(level.stride()) {
    // Counted from a pixel left of and above all that is read, as positive numbers shift to whole pixels
    // below.
    constexpr int kBias = PyramidLevel::kBorder;
    constexpr double kOne = 65536.0, kRounding = 128.0;  // the latter for what is cut off below 1/256 px
    const int whole_x = static_cast<int>(position.x()), whole_y = static_cast<int>(position.y());
    corner_ = level.at(whole_x, whole_y) - kBias * stride_ - kBias;
    const Eigen::Vector2d first = position - Eigen::Vector2d(whole_x - kBias, whole_y - kBias) -
                                  (Side / 2) * (warp.col(0) + warp.col(1));
    x_ = static_cast<int>(kOne * first.x() + kRounding);
    y_ = static_cast<int>(kOne * first.y() + kRounding);
    x_by_row_ = static_cast<int>(kOne * RowStep * warp(0, 1));
    y_by_row_ = static_cast<int>(kOne * RowStep * warp(1, 1));
    const int y_by_column = static_cast<int>(kOne * warp(1, 0));
    rise_ = (Side - 1) * std::abs(y_by_column);
    to_top_ = y_by_column < 0 ? -rise_ : 0;
    const IntLanes column = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    x_ramp_ = column * static_cast<int>(kOne * warp(0, 0));
    y_ramp_ = column * y_by_column;
  }

  /// The next row, first the upmost one and then each RowStep-th below it.
  void sample(Lanes& out) {
    IntLanes x, y, quads, fraction_x, sum;
    fetch(x, y, quads);
    Processor::secondBytes(x, fraction_x);
    blendQuads<Processor>(quads, fraction_x, y, sum);
    out = __builtin_convertvector(sum, Lanes);
    x_ += x_by_row_;
    y_ += y_by_row_;
  }

 private:
  /// The places' whole pixels may be counted from anywhere.
  void fetch(IntLanes& x, IntLanes& y, IntLanes& quads) const {
    if constexpr (Processor::kShufflesBytes) {
      constexpr int kMostRows = 2;  // below the first: four rows of 32 pixels hold them all
      if (rise_ <= kMostRows << 16) {
        const int top = (y_ + to_top_) >> 16, left = x_ >> 16;
        x = x_ramp_ + (x_ - (left << 16));
        y = y_ramp_ + (y_ - (top << 16));
        Processor::fetchQuads(corner_ + top * stride_ + left, stride_, (y >> 11 & ~31) + (x >> 16), quads);
        return;
      }
    }
    x = x_ramp_ + x_;
    y = y_ramp_ + y_;
    fetchQuadsOneByOne(corner_, stride_, (y >> 16) * static_cast<int>(stride_) + (x >> 16), Side, quads);
  }

  std::ptrdiff_t stride_;
  const std::uint8_t* corner_;
  int x_, y_;  // of the next row's first pixel, 1/65536 px from the corner
  int x_by_row_, y_by_row_;
  int rise_;    // of a row from its first pixel to its last, up or down
  int to_top_;  // from a row's first pixel to its upmost one
  IntLanes x_ramp_, y_ramp_;
};

}  // namespace cartvo
