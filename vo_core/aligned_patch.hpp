#pragma once

#include <cstdint>

#include "vo_core/affine_alignment.hpp"
#include "vo_core/lanes.hpp"

namespace cartvo {

/// Of the patch each other row is compared, which halves the work: neighbouring rows tell much the same.
constexpr int kAlignedRowStep = 2;
constexpr int kAlignedRows = (kPatchSide + kAlignedRowStep - 1) / kAlignedRowStep;
constexpr int kAlignedSize = kPatchSide * kAlignedRows;  ///< px
static_assert(kPatchSide < kLanes, "a row of a patch is one of lanes, the last of them padding");

/// The patches that shifts and alignments compare, or a derivative of one: rows of whole numbers, so that
/// sums of their products are exact in whatever order, and fit into 32 bits. Zero in the padding.
struct alignas(64) AlignedPatch {
  static constexpr int kValues = kAlignedRows * kLanes;
  std::int16_t value[kValues];

  constexpr std::int16_t* row(int y) { return value + y * kLanes; }
  constexpr const std::int16_t* row(int y) const { return value + y * kLanes; }
};

// How a pixel between four others is found: by 255ths of a pixel across and 8191sts down, from grey values
// less 128; of the result the upper sixteen bits are kept.
constexpr int kAcross = 255, kDown = 8191;
constexpr double kGreyUnits = kAcross * kDown / 65536.0;  ///< AlignedPatch's numbers to a grey value
constexpr double kMostValue = 128 * kGreyUnits;
static_assert(kAlignedSize * kMostValue * kMostValue < 2147483648.0, "sums of products fit into 32 bits");

/// A number for each of the values.
constexpr AlignedPatch kAlignedOnes = [] {
  AlignedPatch ones{};
  for (int i = 0; i < AlignedPatch::kValues; ++i)
    ones.value[i] = i % kLanes < kPatchSide ? 1 : 0;
  return ones;
}();

}  // namespace cartvo
