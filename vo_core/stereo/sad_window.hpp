#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>

#include "common/simd/lanes.hpp"
#include "vo_core/image/image_pyramid.hpp"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

// Sums of absolute differences (SAD) of windows. Internal to the stereo search.

namespace cartvo::vo {

constexpr int kSadColumns = 16, kSadRows = 9;  ///< px
constexpr int kSadRun = 7;                     ///< windows side by side that are compared together

/// A pixel of a level.
struct LevelPixel {
  int x = 0, y = 0;
};

/// Top left pixel of the window around `pixel`.
inline const std::uint8_t* sadCorner(const PyramidLevel& level, const LevelPixel& pixel) {
  return level.at(pixel.x - kSadColumns / 2, pixel.y - kSadRows / 2);
}

using SadRun = std::array<int, kSadRun>;

/// Compares a window of the left image with windows of the right one.
class SadWindow {
 public:
  SadWindow(const PyramidLevel& left, const LevelPixel& pixel) {
    const std::uint8_t* from = sadCorner(left, pixel);
    for (int row = 0; row < kSadRows; ++row, from += left.stride())
      std::memcpy(&rows_[row], from, kSadColumns);
  }

  /// Computes the SADs with kSadRun windows of the right image: the one around `pixel` and those to its left.
  void compareRun(const PyramidLevel& right, const LevelPixel& pixel, SadRun& sums) const {
    compare<kSadRun>(right, pixel, sums.data());
  }
  int compareOne(const PyramidLevel& right, const LevelPixel& pixel) const {
    int sum;
    compare<1>(right, pixel, &sum);
    return sum;
  }

 private:
  template <int Count>
  void compare(const PyramidLevel& right, const LevelPixel& pixel, int* sums) const {
    const std::uint8_t* from = sadCorner(right, pixel);
#ifdef __SSE2__
    __m128i sum[Count] = {};
#pragma GCC unroll 9
    for (int row = 0; row < kSadRows; ++row, from += right.stride())
#pragma GCC unroll 8
      for (int i = 0; i < Count; ++i)
        sum[i] = _mm_add_epi32(
            sum[i], _mm_sad_epu8(rows_[row], _mm_loadu_si128(reinterpret_cast<const Row*>(from - i))));
    for (int i = 0; i < Count; ++i)
      sums[i] = _mm_cvtsi128_si32(sum[i]) + _mm_extract_epi16(sum[i], 4);
#else
    std::fill_n(sums, Count, 0);
    for (int row = 0; row < kSadRows; ++row, from += right.stride())
      for (int i = 0; i < Count; ++i)
        for (int column = 0; column < kSadColumns; ++column)
          sums[i] += std::abs(rows_[row][column] - from[column - i]);
#endif
  }

#ifdef __SSE2__  // GCC does not always find its sum of sixteen absolute differences by itself
  using Row = __m128i;
#else
  using Row = std::array<std::uint8_t, kSadColumns>;
#endif
  Row rows_[kSadRows];
};

}  // namespace cartvo::vo
