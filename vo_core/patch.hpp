#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>

#include "vo_core/image_pyramid.hpp"
#include "vo_core/lanes.hpp"

namespace cartvo {

/// A small window of grey values around a sub-pixel centre. Rows are padded to whole lanes; the padding is
/// read from the image as well.
template <int Columns, int Rows>
struct Patch {
  static constexpr int kColumns = Columns;
  static constexpr int kRows = Rows;
  static constexpr int kSize = Columns * Rows;
  static constexpr int kBlocks = (Columns + kLanes - 1) / kLanes;  ///< of lanes in a row
  static constexpr int kStride = kLanes * kBlocks;
  alignas(64) float value[Rows * kStride];

  const float* row(int y) const { return value + y * kStride; }
  float* row(int y) { return value + y * kStride; }
  const Lanes& lanes(int y, int block) const {
    return *reinterpret_cast<const Lanes*>(row(y) + kLanes * block);
  }
  Lanes& lanes(int y, int block) { return *reinterpret_cast<Lanes*>(row(y) + kLanes * block); }

  /// One in the window's columns, zero in the padding.
  static constexpr Patch<Columns, 1> mask() {
    Patch<Columns, 1> ones{};
    for (int x = 0; x < Columns; ++x)
      ones.value[x] = 1.0F;
    return ones;
  }
};

/// A place, in pixels and 1/256 px.
struct Fractions {
  explicit Fractions(const Eigen::Vector2d& place)
      : whole_x(static_cast<int>(place.x())),
        whole_y(static_cast<int>(place.y())),
        x(static_cast<std::uint16_t>(256.0 * (place.x() - whole_x) + kHalfAStep)),
        y(static_cast<std::uint16_t>(256.0 * (place.y() - whole_y) + kHalfAStep)) {}

  int whole_x, whole_y;
  std::uint16_t x, y;  ///< 0 to 256

 private:
  static constexpr double kHalfAStep = 0.5;  // what is truncated then is rounded
};

/// Samples the patch around `centre`, which must lie inside the level, by bilinear interpolation,
/// rounded to 1/256 px: between two neighbours in a row, then between two rows, both exactly.
/// Columns must be odd. Of a window of an odd number of rows the first and each RowStep-th after it are kept.
template <typename Processor = AnyProcessor, int RowStep = 1, int Columns, int Rows>
void samplePatch(const PyramidLevel& level, const Eigen::Vector2d& centre, Patch<Columns, Rows>& patch) {
  using P = Patch<Columns, Rows>;
  constexpr int kHalfHeight = (Rows - 1) * RowStep / 2;
  static_assert(P::kStride - Columns / 2 <= PyramidLevel::kBorder && kHalfHeight + 1 < PyramidLevel::kBorder);
  const Fractions at(centre);
  const std::uint16_t fx = at.x;
  const float fy = static_cast<float>(at.y) / 256.0F;
  const std::uint8_t* source = level.at(at.whole_x - Columns / 2, at.whole_y - kHalfHeight);
  const std::ptrdiff_t stride = level.stride();

  // What is read beyond the padding lies in the border, or in that of the next row.
  const auto interpolate_row = [fx](const std::uint8_t* from, Lanes* out) {
#pragma GCC unroll 4
    for (int block = 0; block < P::kBlocks; ++block) {
      ShortLanes here, next;
      Processor::load(from + kLanes * block, here);
      Processor::load(from + kLanes * block + 1, next);
      const ShortLanes between = (here << 8) + fx * (next - here);  // modulo 2^16; the sum is less
      Processor::convert(between, out[block]);
    }
  };
  const float upper_share = (1.0F - fy) / 256.0F, lower_share = fy / 256.0F;
  Lanes upper[P::kBlocks], lower[P::kBlocks];
  interpolate_row(source, upper);
  for (int y = 0; y < Rows; ++y) {
    if (RowStep > 1) interpolate_row(source, upper);
    interpolate_row(source + stride, lower);
    source += RowStep * stride;
#pragma GCC unroll 4
    for (int block = 0; block < P::kBlocks; ++block) {
      patch.lanes(y, block) = upper_share * upper[block] + lower_share * lower[block];
      if (RowStep == 1) upper[block] = lower[block];
    }
  }
}

/// Takes the mean of the window off, which makes what is compared blind to brightness; the padding becomes
/// zero. Returns the mean.
template <int Columns, int Rows>
float removeMean(Patch<Columns, Rows>& patch) {
  using P = Patch<Columns, Rows>;
  static constexpr Patch<Columns, 1> kMask = P::mask();
  Lanes sum{};
  for (int y = 0; y < Rows; ++y)
    for (int block = 0; block < P::kBlocks; ++block)
      sum += patch.lanes(y, block) * kMask.lanes(0, block);
  const float mean = static_cast<float>(sumOf(sum) / P::kSize);
  for (int y = 0; y < Rows; ++y)
    for (int block = 0; block < P::kBlocks; ++block)
      patch.lanes(y, block) = (patch.lanes(y, block) - mean) * kMask.lanes(0, block);
  return mean;
}

/// Of two patches with zero in the padding of at least one.
template <int Columns, int Rows>
double sumOfProducts(const Patch<Columns, Rows>& a, const Patch<Columns, Rows>& b) {
  Lanes sum{};
  for (int y = 0; y < Rows; ++y)
    for (int block = 0; block < Patch<Columns, Rows>::kBlocks; ++block)
      sum += a.lanes(y, block) * b.lanes(y, block);
  return sumOf(sum);
}

namespace patch_detail {
/// sampleGradients() of each other row, in one register a row: by whole numbers, which give the same bits.
template <typename Processor, int Side, int Rows>
void sampleGradientsByShorts(const PyramidLevel& level, const Eigen::Vector2d& centre,
                             Patch<Side, Rows>& grey, Patch<Side, Rows>& gradient_x,
                             Patch<Side, Rows>& gradient_y) {
  static constexpr Patch<Side, 1> kMask = Patch<Side, Rows>::mask();
  constexpr float kUnit = 1.0F / 65536.0F;
  constexpr int kHalf = Side / 2 + 1;
  const Fractions at(centre);
  const std::uint8_t* row = level.at(at.whole_x - kHalf, at.whole_y - kHalf);
  const std::ptrdiff_t stride = level.stride();
  const IntLanes shares = IntLanes{} + ((at.y << 16) + 256 - at.y);

  WideShorts even, odd, next_even, next_odd;
  IntLanes above, left, middle, right, below;
  Processor::blendColumns(row, at.x, even);
  Processor::blendColumns(row + stride, at.x, odd);
  Processor::template blendRows<1>(even, odd, shares, above);
  for (int kept = 0; kept < Rows; ++kept) {
    row += 2 * stride;
    Processor::blendColumns(row, at.x, next_even);
    Processor::blendColumns(row + stride, at.x, next_odd);
    Processor::template blendRows<0>(odd, next_even, shares, left);
    Processor::template blendRows<1>(odd, next_even, shares, middle);
    Processor::template blendRows<2>(odd, next_even, shares, right);
    Processor::template blendRows<1>(next_even, next_odd, shares, below);
    const Lanes in_grey = kUnit * kMask.lanes(0, 0), half = 0.5F * in_grey;
    grey.lanes(kept, 0) = in_grey * __builtin_convertvector(middle + Processor::kRowsLess, Lanes);
    gradient_x.lanes(kept, 0) = half * __builtin_convertvector(right - left, Lanes);
    gradient_y.lanes(kept, 0) = half * __builtin_convertvector(below - above, Lanes);
    odd = next_odd;
    above = below;
  }
}
}  // namespace patch_detail

/// Grey values and their gradients, by central differences, around `centre`; all zero in the padding. Of the
/// window's Side rows the first and each RowStep-th after it are kept, which are Rows.
template <typename Processor = AnyProcessor, int RowStep = 1, int Side, int Rows>
void sampleGradients(const PyramidLevel& level, const Eigen::Vector2d& centre, Patch<Side, Rows>& grey,
                     Patch<Side, Rows>& gradient_x, Patch<Side, Rows>& gradient_y) {
  static_assert(Rows == (Side + RowStep - 1) / RowStep);
  if constexpr (Processor::kShufflesBytes && RowStep == 2 && Patch<Side, Rows>::kBlocks == 1)
    return patch_detail::sampleGradientsByShorts<Processor>(level, centre, grey, gradient_x, gradient_y);
  static constexpr Patch<Side, 1> kMask = Patch<Side, Rows>::mask();
  Patch<Side + 2, Side + 2> wide;
  samplePatch<Processor>(level, centre, wide);
  for (int kept = 0; kept < Rows; ++kept) {
    const int y = RowStep * kept;
    for (int block = 0; block < Patch<Side, Rows>::kBlocks; ++block) {
      const Lanes& mask = kMask.lanes(0, block);
      const int at = kLanes * block;
      Lanes left, middle, right, above, below;
      std::memcpy(&left, wide.row(y + 1) + at, sizeof left);
      std::memcpy(&middle, wide.row(y + 1) + at + 1, sizeof middle);
      std::memcpy(&right, wide.row(y + 1) + at + 2, sizeof right);
      std::memcpy(&above, wide.row(y) + at + 1, sizeof above);
      std::memcpy(&below, wide.row(y + 2) + at + 1, sizeof below);
      grey.lanes(kept, block) = mask * middle;
      gradient_x.lanes(kept, block) = 0.5F * mask * (right - left);
      gradient_y.lanes(kept, block) = 0.5F * mask * (below - above);
    }
  }
}

}  // namespace cartvo
