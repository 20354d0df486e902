#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "vo_core/simd/vector_widths.hpp"

#ifdef CARTVO_WIDE_VECTORS
#include <immintrin.h>
#endif

// SIMD implementation of the FAST-9 corner test and score. Internal to CornerFinder.

namespace cartvo::vo {

constexpr int kCircle = 16;  ///< pixels of the circle

/// Offsets of the circle of radius 3, clockwise from the top, in an image of a given row length in bytes.
using Circle = std::array<std::ptrdiff_t, kCircle>;
inline Circle circle(std::ptrdiff_t step) {
  return {-3 * step, -3 * step + 1, -2 * step + 2, -step + 3, 3,  step + 3,  2 * step + 2,  3 * step + 1,
          3 * step,  3 * step - 1,  2 * step - 2,  step - 3,  -3, -step - 3, -2 * step - 2, -3 * step - 1};
}

/// anyOf(): whether any byte is not 0. bitsOf(): one bit per pixel, which is 0 or 255; the first pixel's is
/// the lowest.
template <int kSize>
bool anyOf(const typename ByteVectors<kSize>::Bytes& pixels) {
  std::array<std::uint64_t, kSize / 8> words;
  std::memcpy(words.data(), &pixels, sizeof pixels);
  std::uint64_t any = 0;
  for (const std::uint64_t word : words)
    any |= word;
  return any != 0;
}
template <int kSize>
std::uint64_t bitsOf(const typename ByteVectors<kSize>::Bytes& pixels) {
  static_assert(std::endian::native == std::endian::little);  // the first byte of a word is its lowest
  constexpr std::uint64_t kOfEachByte = 0x8040201008040201;   // one bit per byte, each at another position
  constexpr std::uint64_t kSum =
      0x0101010101010101;  // multiplication by it sums the bytes into the highest one
  std::array<std::uint64_t, kSize / 8> words;
  std::memcpy(words.data(), &pixels, sizeof pixels);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < words.size(); ++i)
    bits |= (words[i] & kOfEachByte) * kSum >> 56 << 8 * i;
  return bits;
}

#ifdef CARTVO_WIDE_VECTORS
// x86-64 tests a whole register with one instruction, which GCC 12 does not find by itself.
template <>
CARTVO_WIDE_VECTORS("arch=x86-64-v4")
inline bool anyOf<64>(const ByteVectors<64>::Bytes& pixels) {
  return _mm512_test_epi8_mask(__m512i(pixels), __m512i(pixels)) != 0;
}
template <>
CARTVO_WIDE_VECTORS("arch=x86-64-v4")
inline std::uint64_t bitsOf<64>(const ByteVectors<64>::Bytes& pixels) {
  return _mm512_movepi8_mask(__m512i(pixels));
}
template <>
CARTVO_WIDE_VECTORS("arch=x86-64-v3")
inline bool anyOf<32>(const ByteVectors<32>::Bytes& pixels) {
  return _mm256_testz_si256(__m256i(pixels), __m256i(pixels)) == 0;
}
template <>
CARTVO_WIDE_VECTORS("arch=x86-64-v3")
inline std::uint64_t bitsOf<32>(const ByteVectors<32>::Bytes& pixels) {
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(__m256i(pixels)));
}
#endif

/// FAST-9 (fast_corners.hpp) on kSize pixels of a row at once.
template <int kSize>
class PixelBlock {
 public:
  /// `thresholds`: of the pixels from `centre` on.
  PixelBlock(const std::uint8_t* centre, const std::uint8_t* thresholds, const Circle& offsets)
      : centre_(centre), offsets_(offsets) {
    std::memcpy(&grey_, centre, sizeof grey_);
    std::memcpy(&threshold_, thresholds, sizeof threshold_);
  }

  /// Whether any of the pixels is a corner.
  bool findCorners() {
    if (!mayHaveCorners()) return false;
    Pixels greatest, least;
    extremeArcs(greatest, least);
    const Pixels by_bright = (greatest < grey_ ? grey_ : greatest) - grey_;
    const Pixels by_dark = grey_ - (least < grey_ ? least : grey_);
    bright_ = by_bright > threshold_;
    dark_ = by_dark > threshold_;
    return anyOf<kSize>(bright_ | dark_);
  }

  /// Writes the scores of the corners that findCorners() found, 0 for the other pixels.
  void score(std::uint16_t* scores) const {
    // Inverting the grey values makes a darker circle a brighter one.
    const Pixels grey = grey_ ^ dark_;
    const Pixels threshold = threshold_ | ~(bright_ | dark_);
    Shorts sums{}, odd_sums{};  // even pixels plus 256 times odd pixels; odd pixels
#pragma GCC unroll 16
    for (const std::ptrdiff_t offset : offsets_) {
      Pixels pixel;
      std::memcpy(&pixel, centre_ + offset, sizeof pixel);
      pixel ^= dark_;
      const Pixels difference = (pixel < grey ? grey : pixel) - grey;
      const Pixels counted = difference > threshold ? difference : Pixels{};
      const Shorts& pairs = reinterpret_cast<const Shorts&>(counted);
      sums += pairs;
      odd_sums += pairs >> 8;
    }
    writeAlternately(sums - (odd_sums << 8), odd_sums, scores);  // overflows cancel
  }

 private:
  using Pixels = typename ByteVectors<kSize>::Bytes;
  using Shorts = typename ByteVectors<kSize>::Shorts;
  using HalfShorts = typename ByteVectors<kSize / 2>::Shorts;
  using Ints = typename ByteVectors<kSize>::Ints;

  /// Quick test: an arc of nine covers the top or bottom pixel, and the left or right pixel.
  bool mayHaveCorners() const {
    Pixels top, right, bottom, left;
    std::memcpy(&top, centre_ + offsets_[0], sizeof top);
    std::memcpy(&right, centre_ + offsets_[4], sizeof right);
    std::memcpy(&bottom, centre_ + offsets_[8], sizeof bottom);
    std::memcpy(&left, centre_ + offsets_[12], sizeof left);
    const Pixels bright_column = top < bottom ? bottom : top;
    const Pixels bright_row = left < right ? right : left;
    const Pixels dark_column = top < bottom ? top : bottom;
    const Pixels dark_row = left < right ? left : right;
    const Pixels bright = bright_column < bright_row ? bright_column : bright_row;
    const Pixels dark = dark_column < dark_row ? dark_row : dark_column;
    const Pixels brighter = (bright < grey_ ? grey_ : bright) - grey_;
    const Pixels darker = grey_ - (dark < grey_ ? dark : grey_);
    const Pixels more = brighter < darker ? darker : brighter;
    return anyOf<kSize>((more < threshold_ ? threshold_ : more) - threshold_);
  }

  /// Over all arcs of nine pixels: the greatest minimum and the least maximum.
  void extremeArcs(Pixels& greatest, Pixels& least) const {
    Pixels pixel[kCircle];
#pragma GCC unroll 16
    for (int i = 0; i < kCircle; ++i)
      std::memcpy(&pixel[i], centre_ + offsets_[i], sizeof(Pixels));
    // The arcs that begin at 2 i and 2 i + 1 have eight pixels in common, from 2 i + 1 on.
    constexpr int kPairs = kCircle / 2;
    Pixels low[kPairs], high[kPairs];
#pragma GCC unroll 8
    for (int i = 0; i < kPairs; ++i) {
      const Pixels& a = pixel[2 * i + 1];
      const Pixels& b = pixel[(2 * i + 2) % kCircle];
      low[i] = a < b ? a : b;
      high[i] = a < b ? b : a;
    }
    Pixels low4[kPairs], high4[kPairs];
#pragma GCC unroll 8
    for (int i = 0; i < kPairs; ++i) {
      const int next = (i + 1) % kPairs;
      low4[i] = low[i] < low[next] ? low[i] : low[next];
      high4[i] = high[i] < high[next] ? high[next] : high[i];
    }
    greatest = Pixels{};
    least = ~Pixels{};
#pragma GCC unroll 8
    for (int i = 0; i < kPairs; ++i) {
      const int next = (i + 2) % kPairs;
      const Pixels& before = pixel[2 * i];
      const Pixels& after = pixel[(2 * i + 9) % kCircle];
      const Pixels low8 = low4[i] < low4[next] ? low4[i] : low4[next];
      const Pixels high8 = high4[i] < high4[next] ? high4[next] : high4[i];
      const Pixels more = before < after ? after : before;
      const Pixels less = before < after ? before : after;
      const Pixels low9 = low8 < more ? low8 : more;
      const Pixels high9 = high8 < less ? less : high8;
      greatest = greatest < low9 ? low9 : greatest;
      least = least < high9 ? least : high9;
    }
  }

  static void writeAlternately(const Shorts& even, const Shorts& odd, std::uint16_t* to) {
    HalfShorts evens[2], odds[2];
    std::memcpy(evens, &even, sizeof even);
    std::memcpy(odds, &odd, sizeof odd);
    for (int half = 0; half < 2; ++half) {
      const Ints both = __builtin_convertvector(evens[half], Ints) | __builtin_convertvector(odds[half], Ints)
                                                                         << 16;
      std::memcpy(to + half * kSize / 2, &both, sizeof both);
    }
  }

  const std::uint8_t* centre_;
  const Circle& offsets_;
  Pixels grey_, threshold_;
  Pixels bright_{}, dark_{};  ///< 255 where the circle has such an arc, else 0
};

}  // namespace cartvo::vo
