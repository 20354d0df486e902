#pragma once

#include <cstdint>

#include "common/simd/lanes.hpp"
#include "vo_core/image/affine_alignment.hpp"

// Integer patches that shift tracking and affine alignment compare. Internal to tracking and stereo matching.

namespace cartvo::vo {

/// Row step of the compared patch. Every second row is compared, which halves the work; neighbouring rows
/// carry nearly the same information.
constexpr int kAlignedRowStep = 2;
constexpr int kAlignedRows = (kPatchSide + kAlignedRowStep - 1) / kAlignedRowStep;
constexpr int kAlignedSize = kPatchSide * kAlignedRows;  ///< px
static_assert(kPatchSide < kLanes, "a patch row and its padding fill the lanes");

/// A patch, or a derivative of one, as shift tracking and alignment compare it: rows of integers, so that
/// sums of their products are exact in any order and fit into 32 bits. The padding is zero.
struct alignas(64) AlignedPatch {
  static constexpr int kValues = kAlignedRows * kLanes;
  std::int16_t value[kValues];

  constexpr std::int16_t* row(int y) { return value + y * kLanes; }
  constexpr const std::int16_t* row(int y) const { return value + y * kLanes; }
};

// Bilinear interpolation in integers: in 255ths of a pixel horizontally and 8191sts vertically, of grey
// values less 128; the upper sixteen bits of the result are kept.
constexpr int kColumnSteps = 255, kRowSteps = 8191;
constexpr double kGreyUnits =
    kColumnSteps * kRowSteps / 65536.0;  ///< units of an AlignedPatch per grey value
constexpr double kMaximumValue = 128 * kGreyUnits;
static_assert(kAlignedSize * kMaximumValue * kMaximumValue < 2147483648.0,
              "sums of products fit into 32 bits");

/// Ones in the patch, zeros in the padding: products with it sum the values of a patch.
constexpr AlignedPatch kAlignedOnes = [] {
  AlignedPatch ones{};
  for (int i = 0; i < AlignedPatch::kValues; ++i)
    ones.value[i] = i % kLanes < kPatchSide ? 1 : 0;
  return ones;
}();

}  // namespace cartvo::vo
