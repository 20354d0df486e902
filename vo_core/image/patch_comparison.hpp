#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <cstring>

#include "vo_core/image/aligned_patch.hpp"
#include "vo_core/image/constant_fraction_sampler.hpp"
#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/image/patch_lanes.hpp"
#include "vo_core/image/patch_sums.hpp"
#include "vo_core/image/warped_patch.hpp"

// Building of templates from patches of the first image, and their comparison with patches of the second one.
// Internal to tracking.

namespace cartvo::vo {

/// Template of the patch in the first image: its derivatives by the warp parameters (the gradient in x or y,
/// times 1 or times the pixel's offset from the centre in half patch sides) and its grey values.
template <int Parameters>
struct AlignedTemplate {
  AlignedPatch slopes[Parameters];
  AlignedPatch grey;
};

namespace patch_comparison_detail {

/// Offset of each pixel from the centre in half patch sides, times 32768.
struct Offsets {
  AlignedPatch x{}, y{};
};
constexpr Offsets kOffsets = [] {
  Offsets offsets;
  for (int row = 0; row < kAlignedRows; ++row) {
    for (int column = 0; column < kPatchSide; ++column) {
      constexpr int kHalf = kPatchSide / 2;
      constexpr double kPerPixel = 32768.0 / (0.5 * kPatchSide);
      offsets.x.row(row)[column] = static_cast<std::int16_t>(kPerPixel * (column - kHalf));
      offsets.y.row(row)[column] = static_cast<std::int16_t>(kPerPixel * (kAlignedRowStep * row - kHalf));
    }
  }
  return offsets;
}();

/// Sums the products of patches, of which `patch(i)` is the i-th; at most as many sums at once as there are
/// registers.
template <typename Sums, int Values, int First = 0, typename PatchAt>
void sumProducts(const PatchAt& patch, SumsOfPatch<Sums>& sums) {
  static constexpr auto kProducts = Sums::products();
  constexpr int kMaximumSums = 12;
  constexpr int kCount = Sums::kCount - First < kMaximumSums ? Sums::kCount - First : kMaximumSums;
  PatchLanes::sumProducts<kCount, Values>([&](int i) { return patch(kProducts[First + i].a); },
                                          [&](int i) { return patch(kProducts[First + i].b); },
                                          sums.data() + First);
  if constexpr (First + kCount < Sums::kCount) sumProducts<Sums, Values, First + kCount>(patch, sums);
}

/// Samples grey values and gradients (central differences).
inline void sampleGradients(const PyramidLevel& level, const Eigen::Vector2d& centre, AlignedPatch& grey,
                            AlignedPatch& gradient_x, AlignedPatch& gradient_y) {
  using Lanes = PatchLanes;
  // Column 0 lies left of the patch.
  ConstantFractionSampler rows(level, centre, kPatchSide / 2 + 1, kPatchSide / 2);
  IntLanes above, below;
  rows.load(-1);
  rows.template sample<1>(above);
  IntLanes middle[2], across[2], down[2];
  for (int row = 0; row < kAlignedRows; row += 2) {
#pragma GCC unroll 2
    for (int i = 0; i < 2; ++i) {
      IntLanes left, right;
      rows.load(kAlignedRowStep * (row + i));
      rows.template sample<0>(left);
      rows.template sample<1>(middle[i]);
      rows.template sample<2>(right);
      across[i] = right - left;
      rows.load(kAlignedRowStep * (row + i) + 1);
      rows.template sample<1>(below);
      down[i] = below - above;
      above = below;
    }
    Lanes::store(middle[0], middle[1], grey.row(row));
    Lanes::storeHalf(across[0], across[1], gradient_x.row(row));
    Lanes::storeHalf(down[0], down[1], gradient_y.row(row));
  }
}

/// The pixels of a patch with neighbours on all sides; zero elsewhere.
struct alignas(64) InnerPatch {
  static constexpr int kValues = AlignedPatch::kValues - 2 * kLanes;
  std::int16_t value[kValues];
};

constexpr int kShorts = 2 * kLanes;
using Shorts = std::int16_t __attribute__((vector_size(2 * kShorts), may_alias));

/// Gradients of kShorts values from the pixels `apart` px behind and before each.
inline void innerDifference(const std::int16_t* behind, const std::int16_t* before, int apart,
                            std::int16_t* gradient) {
  static constexpr auto kInner = [] {
    std::array<std::int16_t, kShorts> inner{};
    for (int i = 0; i < kShorts; ++i)
      inner[i] = i % kLanes > 0 && i % kLanes < kPatchSide - 1 ? -1 : 0;
    return inner;
  }();
  Shorts more, less, mask;
  std::memcpy(&more, behind, sizeof more);
  std::memcpy(&less, before, sizeof less);
  std::memcpy(&mask, kInner.data(), sizeof mask);
  const Shorts rounded = ((more - less) + static_cast<std::int16_t>(apart)) >> apart & mask;
  std::memcpy(gradient, &rounded, sizeof rounded);
}

}  // namespace patch_comparison_detail

/// Builds the template around `centre` (px of the level, inside it) and its sums.
template <int Parameters>
void buildTemplate(const PyramidLevel& level, const Eigen::Vector2d& centre, AlignedTemplate<Parameters>& out,
                   SumsOfPatch<TemplateSums<Parameters>>& sums) {
  namespace detail = patch_comparison_detail;
  AlignedPatch* const slopes = out.slopes;
  detail::sampleGradients(level, centre, out.grey, slopes[0], slopes[1]);
  const auto multiply = [](const AlignedPatch& gradient, const AlignedPatch& offsets, AlignedPatch& slope) {
    PatchLanes::multiply<AlignedPatch::kValues>(gradient.value, offsets.value, slope.value);
  };
#pragma GCC unroll 2
  for (int axis = 0; axis < Parameters / 2 - 1; ++axis) {
    multiply(slopes[axis], detail::kOffsets.x, slopes[2 + 2 * axis]);
    multiply(slopes[axis], detail::kOffsets.y, slopes[3 + 2 * axis]);
  }
  using Sums = TemplateSums<Parameters>;
  detail::sumProducts<Sums, AlignedPatch::kValues>(
      [&](int i) {
        return i < Parameters ? slopes[i].value : i == Sums::kGrey ? out.grey.value : kAlignedOnes.value;
      },
      sums);
}

/// Samples the patch around `position` (px of the level, inside it).
inline void samplePatch(const PyramidLevel& level, const Eigen::Vector2d& position, AlignedPatch& patch) {
  ConstantFractionSampler rows(level, position, kPatchSide / 2, kPatchSide / 2);
  IntLanes sum[2];
  for (int row = 0; row < kAlignedRows; row += 2) {
#pragma GCC unroll 2
    for (int i = 0; i < 2; ++i) {
      rows.load(kAlignedRowStep * (row + i));
      rows.template sample<0>(sum[i]);
    }
    PatchLanes::store(sum[0], sum[1], patch.row(row));
  }
}

/// Samples the patch under a warp (WarpedRows).
inline void samplePatch(const PyramidLevel& level, const Eigen::Vector2d& position,
                        const Eigen::Matrix2d& warp, AlignedPatch& patch) {
  WarpedRows(level, position, warp).sample(patch);
}

template <int Parameters>
void comparePatches(const AlignedTemplate<Parameters>& before, const AlignedPatch& now,
                    SumsOfPatch<ComparisonSums<Parameters>>& sums) {
  using Sums = ComparisonSums<Parameters>;
  patch_comparison_detail::sumProducts<Sums, AlignedPatch::kValues>(
      [&](int i) {
        return i < Parameters     ? before.slopes[i].value
               : i == Sums::kNow  ? now.value
               : i == Sums::kGrey ? before.grey.value
                                  : kAlignedOnes.value;
      },
      sums);
}

/// Sums for the forward-backward error: for the shift by the gradients of the template and for that by the
/// gradients of the patch after, `now`. Leaves out the edge of the patch, where the gradients of `now` are
/// unknown.
template <int Parameters>
void compareForwardBackward(const AlignedTemplate<Parameters>& before, const AlignedPatch& now,
                            SumsOfPatch<ForwardBackwardSums>& sums) {
  namespace detail = patch_comparison_detail;
  detail::InnerPatch backward_x, backward_y, forward_x, forward_y;
  for (int i = 0; i < detail::InnerPatch::kValues; i += detail::kShorts) {
    const std::int16_t *const after = now.row(1) + i, *const grey = before.grey.row(1) + i;
    detail::innerDifference(after + 1, after - 1, 1, backward_x.value + i);
    detail::innerDifference(after + kLanes, after - kLanes, kAlignedRowStep, backward_y.value + i);
    detail::innerDifference(grey + 1, grey - 1, 1, forward_x.value + i);
    detail::innerDifference(grey + kLanes, grey - kLanes, kAlignedRowStep, forward_y.value + i);
  }
  const std::int16_t* const patches[] = {backward_x.value,   backward_y.value, forward_x.value,
                                         forward_y.value,    now.row(1),       before.grey.row(1),
                                         kAlignedOnes.row(1)};
  detail::sumProducts<ForwardBackwardSums, detail::InnerPatch::kValues>([&](int i) { return patches[i]; },
                                                                        sums);
}

}  // namespace cartvo::vo
