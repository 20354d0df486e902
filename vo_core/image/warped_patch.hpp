#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstdlib>

#include "common/simd/bilinear_gather.hpp"
#include "vo_core/image/aligned_patch.hpp"
#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/image/patch_lanes.hpp"

// Sampling of a patch under an affine warp, in fixed-point arithmetic. Internal to tracking.

namespace cartvo::vo {

/// Samples the rows of a patch around `position`, which must lie inside the level. The warp maps offsets in
/// the patch to offsets in the level. Coordinates are integers in 1/65536 px.
class WarpedRows {
 public:
  /// The warped patch must not reach beyond the level's border, nor may the warp reverse the order of
  /// columns.
  WarpedRows(const PyramidLevel& level, const Eigen::Vector2d& position, const Eigen::Matrix2d& warp)
      : stride_(level.stride()) {
    // Coordinates count from a pixel left of and above all pixels that are read, because only positive
    // numbers shift to whole pixels below.
    constexpr int kBias = PyramidLevel::kBorder;
    constexpr double kOne = 65536.0;
    const int whole_x = static_cast<int>(position.x()), whole_y = static_cast<int>(position.y());
    corner_ = level.at(whole_x, whole_y) - kBias * stride_ - kBias;
    const Eigen::Vector2d first = position - Eigen::Vector2d(whole_x - kBias, whole_y - kBias) -
                                  (kPatchSide / 2) * (warp.col(0) + warp.col(1));
    x_ = static_cast<int>(kOne * first.x());
    y_ = static_cast<int>(kOne * first.y());
    x_by_row_ = static_cast<int>(kOne * kAlignedRowStep * warp(0, 1));
    y_by_row_ = static_cast<int>(kOne * kAlignedRowStep * warp(1, 1));
    const int y_by_column = static_cast<int>(kOne * warp(1, 0));
    const IntLanes column = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    x_ramp_ = column * static_cast<int>(kOne * warp(0, 0));
    y_ramp_ = column * y_by_column;
  }

  /// Samples the top row, then every kAlignedRowStep-th row below it.
  void sample(AlignedPatch& patch) {
    IntLanes sum[2];
    for (int row = 0; row < kAlignedRows; row += 2) {
#pragma GCC unroll 2
      for (IntLanes& of_row : sum) {
        blendRow(of_row);
        x_ += x_by_row_;
        y_ += y_by_row_;
      }
      PatchLanes::store(sum[0], sum[1], patch.row(row));
    }
  }

 private:
  void blendRow(IntLanes& sum) const {
    const IntLanes x = x_ramp_ + x_, y = y_ramp_ + y_;
    IntLanes neighbours;
    gather2x2Scalar(corner_, stride_, (y >> 16) * static_cast<int>(stride_) + (x >> 16), kPatchSide,
                    neighbours);
    PatchLanes::blendGathered(neighbours, x, y, sum);
  }

  std::ptrdiff_t stride_;
  const std::uint8_t* corner_;
  int x_, y_;  // first pixel of the next row, 1/65536 px from the corner
  int x_by_row_, y_by_row_;
  IntLanes x_ramp_, y_ramp_;
};

}  // namespace cartvo::vo
