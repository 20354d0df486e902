#pragma once

#include <array>
#include <cstring>

#include "vo_core/affine_sums.hpp"
#include "vo_core/aligned_template.hpp"
#include "vo_core/lanes.hpp"
#include "vo_core/warped_patch.hpp"

// The patches of an affine alignment, and how they are summed over. Not for use outside it.

namespace cartvo {

namespace affine_patch_detail {
constexpr int kHalf = kPatchSide / 2;

/// A pixel's offset from the centre, scaled by the patch's half side.
constexpr float scaledOffset(int pixel) {
  return static_cast<float>((pixel - kHalf) / (0.5 * kPatchSide));
}
/// The same of the rows that are compared.
constexpr auto kRowOffset = [] {
  std::array<float, kAlignedRows> offsets{};
  for (int row = 0; row < kAlignedRows; ++row)
    offsets[row] = scaledOffset(kAlignedRowStep * row);
  return offsets;
}();
using Row = Patch<kPatchSide, 1>;
constexpr Row kRamp = [] {
  Row offsets{};
  for (int x = 0; x < kPatchSide; ++x)
    offsets.value[x] = scaledOffset(x);
  return offsets;
}();
constexpr Row kInner = [] {
  Row ones{};
  for (int x = 1; x < kPatchSide - 1; ++x)
    ones.value[x] = 1.0F;
  return ones;
}();

/// Column by column, sums of something times 1 or the scaled row offset.
struct ColumnSums {
  Lanes one{}, y{};

  void add(const Lanes& lanes, float offset_y) {
    one += lanes;
    y += lanes * offset_y;
  }
};

/// Of the six derivatives, in the order of the parameters, from those of the gradients.
inline void slopeSums(const ColumnSums& along_x, const ColumnSums& along_y, Lanes* sums) {
  const Lanes& ramp = kRamp.lanes(0, 0);
  sums[0] = along_x.one;
  sums[1] = along_y.one;
  sums[2] = along_x.one * ramp;
  sums[3] = along_x.y;
  sums[4] = along_y.one * ramp;
  sums[5] = along_y.y;
}

inline void momentsOf(const AlignedPatch& a, const AlignedPatch& b, GradientMoments<OfColumns>& moments) {
  Lanes one{}, y{}, yy{};
  for (int row = 0; row < kAlignedRows; ++row) {
    const float offset_y = kRowOffset[row];
    const Lanes product = a.lanes(row, 0) * b.lanes(row, 0);
    one += product;
    y += product * offset_y;
    yy += product * (offset_y * offset_y);
  }
  const Lanes& ramp = kRamp.lanes(0, 0);
  const Lanes x = one * ramp;
  moments = {one, x, y, x * ramp, y * ramp, yy};
}

struct ShiftColumns {
  ShiftSums<OfColumns> sums{};

  void add(const Lanes& slope_x, const Lanes& slope_y, const Lanes& error) {
    sums.xx += slope_x * slope_x;
    sums.xy += slope_x * slope_y;
    sums.yy += slope_y * slope_y;
    sums.x += slope_x * error;
    sums.y += slope_y * error;
  }
};
}  // namespace affine_patch_detail

/// The template around `centre`, px of the level, and what its equations need of it. A derivative by a
/// parameter is a gradient times 1 or the pixel's offset.
template <typename Processor>
void sampleTemplate(const PyramidLevel& level, const Eigen::Vector2d& centre, AlignedTemplate& out,
                    TemplateSums<OfPatch>& sums) {
  namespace detail = affine_patch_detail;
  takeTemplate<Processor>(level, centre, out);
  TemplateSums<OfColumns> columns;
  detail::momentsOf(out.gradient_x, out.gradient_x, columns.xx);
  detail::momentsOf(out.gradient_x, out.gradient_y, columns.xy);
  detail::momentsOf(out.gradient_y, out.gradient_y, columns.yy);
  detail::ColumnSums along_x, along_y, grey_along_x, grey_along_y;
  columns.squares = columns.unused = Lanes{};
  for (int row = 0; row < kAlignedRows; ++row) {
    const float offset_y = detail::kRowOffset[row];
    const Lanes& grey = out.grey.lanes(row, 0);
    along_x.add(out.gradient_x.lanes(row, 0), offset_y);
    along_y.add(out.gradient_y.lanes(row, 0), offset_y);
    grey_along_x.add(out.gradient_x.lanes(row, 0) * grey, offset_y);
    grey_along_y.add(out.gradient_y.lanes(row, 0) * grey, offset_y);
    columns.squares += grey * grey;
  }
  detail::slopeSums(along_x, along_y, columns.slopes);
  detail::slopeSums(grey_along_x, grey_along_y, columns.slope_greys);
  foldColumns(columns, sums);
}

/// The patch after under a warp, less the template's mean, and how it compares with the template. What is in
/// the padding means nothing.
template <typename Processor>
void comparePatches(const AlignedTemplate& before, const PyramidLevel& after, const Eigen::Vector2d& position,
                    const Eigen::Matrix2d& warp, AlignedPatch& now, ComparisonSums<OfPatch>& sums) {
  namespace detail = affine_patch_detail;
  using Rows = WarpedRows<Processor, kPatchSide, kAlignedRowStep>;
  Rows rows(after, position, warp);
  ComparisonSums<OfColumns> columns{};
  detail::ColumnSums along_x, along_y;
  for (int y = 0; y < kAlignedRows; ++y) {
    Lanes sampled;
    rows.sample(sampled);
    // Small numbers, so that little is rounded.
    const Lanes value = sampled * Rows::kUnit - before.mean;
    now.lanes(y, 0) = value;
    columns.values += value;
    columns.squares += value * value;
    columns.products += value * before.grey.lanes(y, 0);
    along_x.add(before.gradient_x.lanes(y, 0) * value, detail::kRowOffset[y]);
    along_y.add(before.gradient_y.lanes(y, 0) * value, detail::kRowOffset[y]);
  }
  columns.values *= kAlignedMask.lanes(0, 0);
  columns.squares *= kAlignedMask.lanes(0, 0);
  detail::slopeSums(along_x, along_y, columns.slopes);
  foldColumns(columns, sums);
}

/// For the shift that the template's gradients ask for, and for that by the gradients of the patch after,
/// which looks so: `now`.
inline void compareBothWays(const AlignedTemplate& before, const AlignedPatch& now, float mean, float gain,
                            ReturnSums<OfPatch>& sums) {
  namespace detail = affine_patch_detail;
  detail::ShiftColumns backward, forward;
  const Lanes& mask = detail::kInner.lanes(0, 0);
  for (int row = 1; row < kAlignedRows - 1; ++row) {
    const float* const here = now.row(row);
    Lanes left, right;
    std::memcpy(&left, here - 1, sizeof left);
    std::memcpy(&right, here + 1, sizeof right);
    const Lanes error = now.lanes(row, 0) - mean - gain * before.grey.lanes(row, 0);
    backward.add(mask * (right - left),
                 mask / (1.0F * kAlignedRowStep) * (now.lanes(row + 1, 0) - now.lanes(row - 1, 0)), error);
    forward.add(
        mask * before.gradient_x.lanes(row, 0),
        mask * (0.5F / kAlignedRowStep) * (before.grey.lanes(row + 1, 0) - before.grey.lanes(row - 1, 0)),
        error);
  }
  ReturnSums<OfColumns> columns{};
  columns.backward = backward.sums;
  columns.forward = forward.sums;
  foldColumns(columns, sums);
}

}  // namespace cartvo
