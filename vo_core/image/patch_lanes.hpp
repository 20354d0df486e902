#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/simd/lanes.hpp"
#include "vo_core/image/aligned_patch.hpp"

// SIMD kernels on sixteen or more values of an AlignedPatch. Internal to tracking and stereo matching.

namespace cartvo::vo {

/// Sub-pixel position of a patch's pixels: distance to the whole pixel to the left and above.
struct PixelFraction {
  int right = 0;  ///< in 1/kColumnSteps px
  int lower = 0;  ///< in 1/kRowSteps px
};

constexpr int kMaximumWindows = 8;  ///< windows that are compared at once
using WindowSumLanes = std::int32_t __attribute__((vector_size(4 * kMaximumWindows), may_alias));

/// The kernels.
class PatchLanes {
 public:
  /// Two adjacent rows of pixels.
  struct RowPair {
    const std::uint8_t *upper, *lower;
  };
  using Weights = PixelFraction;

  static void setWeights(const PixelFraction& fraction, Weights& out) { out = fraction; }
  static void load(const std::uint8_t* first, std::ptrdiff_t stride, RowPair& rows) {
    rows = {first, first + stride};
  }

  /// Interpolates sixteen pixels between both rows from `Column` on; 65536 per unit of an AlignedPatch.
  template <int Column>
  static void blend(const RowPair& rows, const Weights& weights, IntLanes& sum) {
    IntLanes upper, lower;
    blendAcross(rows.upper + Column, weights.right, upper);
    blendAcross(rows.lower + Column, weights.right, lower);
    sum = (kRowSteps - weights.lower) * upper + weights.lower * lower;
  }

  /// Interpolates sixteen 2x2 neighbourhoods (bilinear_gather.hpp), each at its own coordinates in 1/65536
  /// px.
  static void blendGathered(const IntLanes& neighbours, const IntLanes& x, const IntLanes& y, IntLanes& sum) {
    const IntLanes right = x >> 8 & 255, lower = y >> 3 & kRowSteps;
    const IntLanes above =
        kColumnSteps * ((neighbours & 255) - 128) + right * ((neighbours >> 8 & 255) - (neighbours & 255));
    const IntLanes below = kColumnSteps * ((neighbours >> 16 & 255) - 128) +
                           right * ((neighbours >> 24 & 255) - (neighbours >> 16 & 255));
    sum = (kRowSteps - lower) * above + lower * below;
  }

  /// Stores two rows of a patch.
  static void store(const IntLanes& upper, const IntLanes& lower, std::int16_t* to) {
    storeRow(upper >> 16, to);
    storeRow(lower >> 16, to + kLanes);
  }
  /// Stores half of the values, rounded: for differences over two pixels.
  static void storeHalf(const IntLanes& upper, const IntLanes& lower, std::int16_t* to) {
    storeRow((upper + 65536) >> 17, to);
    storeRow((lower + 65536) >> 17, to + kLanes);
  }

  /// Stores half of the values of a row of 32, rounded, without padding.
  static void storeHalfRow(const IntLanes& left, const IntLanes& right, std::int16_t* to) {
    const SignedShorts halves[] = {__builtin_convertvector((left + 65536) >> 17, SignedShorts),
                                   __builtin_convertvector((right + 65536) >> 17, SignedShorts)};
    std::memcpy(to, halves, sizeof halves);
  }

  /// product = a b / 32768, rounded, for each of the first `Values` values.
  template <int Values>
  static void multiply(const std::int16_t* a, const std::int16_t* b, std::int16_t* product) {
    for (int i = 0; i < Values; ++i)
      product[i] = static_cast<std::int16_t>((a[i] * b[i] + 16384) >> 15);
  }

  /// Sums the products of the `Values` values of left(i) and right(i), which are constants to the compiler.
  template <int Count, int Values, typename Left, typename Right>
  static void sumProducts(const Left& left, const Right& right, std::int32_t* sums) {
#pragma GCC unroll 16
    for (int i = 0; i < Count; ++i) {
      const std::int16_t *const a = left(i), *const b = right(i);
      std::int32_t sum = 0;
      for (int k = 0; k < Values; ++k)
        sum += a[k] * b[k];
      sums[i] = sum;
    }
  }

  /// For `Count` < kMaximumWindows windows side by side, whose rows lie `Stride` apart: sums of products with
  /// a template, of values and of squares, all without the last column. The other lanes of the results are
  /// undefined.
  template <int Count, int Rows, int Stride>
  static void sumWindows(const std::int16_t* window, const std::int16_t* others, WindowSumLanes& products,
                         WindowSumLanes& values, WindowSumLanes& squares) {
    products = values = squares = WindowSumLanes{};
    for (int i = 0; i < Count; ++i) {
      std::int32_t product = 0, sum = 0, square = 0;
      for (int y = 0; y < Rows; ++y) {
        const std::int16_t *const a = window + y * kLanes, *const b = others + y * Stride + i;
        for (int x = 0; x < kLanes - 1; ++x) {
          product += a[x] * b[x];
          sum += b[x];
          square += b[x] * b[x];
        }
      }
      products[i] = product;
      values[i] = sum;
      squares[i] = square;
    }
  }

 private:
  using SignedShorts = std::int16_t __attribute__((vector_size(2 * kLanes)));

  static void blendAcross(const std::uint8_t* from, int right, IntLanes& sum) {
    ShortLanes here, next;
    LaneOperations::load(from, here);
    LaneOperations::load(from + 1, next);
    // Modulo 2^16, which the sum does not exceed.
    const ShortLanes blended = (here << 8) - here - std::uint16_t{kColumnSteps * 128} +
                               static_cast<std::uint16_t>(right) * (next - here);
    sum = __builtin_convertvector(SignedShorts(blended), IntLanes);
  }
  static void storeRow(const IntLanes& row, std::int16_t* to) {
    SignedShorts shorts = __builtin_convertvector(row, SignedShorts);
    shorts[kLanes - 1] = 0;
    std::memcpy(to, &shorts, sizeof shorts);
  }
};

}  // namespace cartvo::vo
