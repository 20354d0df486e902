#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "vo_core/aligned_patch.hpp"
#include "vo_core/lanes.hpp"

// What is done with sixteen or more numbers of an AlignedPatch at once, by what the processor can do: the
// same bits by each. Not for use outside tracking.

namespace cartvo {

/// By how much of the way to the next pixel a patch's pixels lie behind whole ones.
struct PixelShares {
  int right = 0;  ///< of kAcross
  int lower = 0;  ///< of kDown
};

constexpr int kMostWindows = 8;  ///< that are compared at once
using WindowSums = std::int32_t __attribute__((vector_size(4 * kMostWindows), may_alias));

/// For any processor.
template <typename Processor>
class PatchLanes {
 public:
  /// Two rows of pixels, one below the other.
  struct RowPair {
    const std::uint8_t *upper, *lower;
  };
  using Shares = PixelShares;

  static void share(const PixelShares& shares, Shares& out) { out = shares; }
  static void load(const std::uint8_t* first, std::ptrdiff_t stride, RowPair& rows) {
    rows = {first, first + stride};
  }

  /// Sixteen pixels between those of both rows from `Column` on, 65536 to an AlignedPatch's unit.
  template <int Column>
  static void blend(const RowPair& rows, const Shares& shares, IntLanes& sum) {
    IntLanes upper, lower;
    blendAcross(rows.upper + Column, shares.right, upper);
    blendAcross(rows.lower + Column, shares.right, lower);
    sum = (kDown - shares.lower) * upper + shares.lower * lower;
  }

  /// The same of quads (quads.hpp), each with shares of its own: places in 1/65536 px.
  static void blendQuads(const IntLanes& quads, const IntLanes& x, const IntLanes& y, IntLanes& sum) {
    const IntLanes right = x >> 8 & 255, lower = y >> 3 & kDown;
    const IntLanes above = kAcross * ((quads & 255) - 128) + right * ((quads >> 8 & 255) - (quads & 255));
    const IntLanes below =
        kAcross * ((quads >> 16 & 255) - 128) + right * ((quads >> 24 & 255) - (quads >> 16 & 255));
    sum = (kDown - lower) * above + lower * below;
  }

  /// Two rows of a patch.
  static void store(const IntLanes& upper, const IntLanes& lower, std::int16_t* to) {
    storeRow(upper >> 16, to);
    storeRow(lower >> 16, to + kLanes);
  }
  /// Half of it, rounded: for differences over two pixels.
  static void storeHalf(const IntLanes& upper, const IntLanes& lower, std::int16_t* to) {
    storeRow((upper + 65536) >> 17, to);
    storeRow((lower + 65536) >> 17, to + kLanes);
  }

  /// The same of a row of 32, without padding.
  static void storeHalfRow(const IntLanes& left, const IntLanes& right, std::int16_t* to) {
    const SignedShorts halves[] = {__builtin_convertvector((left + 65536) >> 17, SignedShorts),
                                   __builtin_convertvector((right + 65536) >> 17, SignedShorts)};
    std::memcpy(to, halves, sizeof halves);
  }

  /// Of the first `Values` numbers a and b: a times b / 32768, rounded.
  template <int Values>
  static void multiply(const std::int16_t* a, const std::int16_t* b, std::int16_t* product) {
    for (int i = 0; i < Values; ++i)
      product[i] = static_cast<std::int16_t>((a[i] * b[i] + 16384) >> 15);
  }

  /// Sums of products of the `Values` numbers of left(i) and right(i), which are constants to the compiler.
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

  /// Of `Count` < kMostWindows windows side by side, whose rows lie `Stride` apart: sums of products with a
  /// template, both without the last column, of values and of squares. The other sums mean nothing.
  template <int Count, int Rows, int Stride>
  static void sumWindows(const std::int16_t* window, const std::int16_t* others, WindowSums& products,
                         WindowSums& values, WindowSums& squares) {
    products = values = squares = WindowSums{};
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
    Processor::load(from, here);
    Processor::load(from + 1, next);
    // Modulo 2^16; the sum is less.
    const ShortLanes blended =
        (here << 8) - here - std::uint16_t{kAcross * 128} + static_cast<std::uint16_t>(right) * (next - here);
    sum = __builtin_convertvector(SignedShorts(blended), IntLanes);
  }
  static void storeRow(const IntLanes& row, std::int16_t* to) {
    SignedShorts shorts = __builtin_convertvector(row, SignedShorts);
    shorts[kLanes - 1] = 0;
    std::memcpy(to, &shorts, sizeof shorts);
  }
};

#ifdef CARTVO_BYTE_SHUFFLES
/// AVX-512 with VBMI and VNNI: four pixels are blended by one instruction across and one down, and products
/// of 32 numbers summed by one. Forms with a full mask, as GCC 12 warns of its own ones without.
template <>
class PatchLanes<ByteShufflingProcessor> {
 public:
  using Processor = ByteShufflingProcessor;
  using RowPair = IntLanes;
  struct Shares {
    IntLanes across, down;
  };

  CARTVO_BYTE_SHUFFLES static void share(const PixelShares& shares, Shares& out) {
    out.across = IntLanes{} + (shares.right * 0x01010101 ^ kLeftBytes);
    out.down = IntLanes{} + (shares.lower << 16 | (kDown - shares.lower));
  }
  CARTVO_BYTE_SHUFFLES static void load(const std::uint8_t* first, std::ptrdiff_t stride, RowPair& rows) {
    rows = IntLanes(Processor::rowPair(first, first + stride)) ^ kMiddleGrey;
  }

  template <int Column>
  CARTVO_BYTE_SHUFFLES static void blend(const RowPair& rows, const Shares& shares, IntLanes& sum) {
    const IntLanes column = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const IntLanes places = (column + Column) * 0x01010101 + Processor::kQuad;
    const __m512i quads = _mm512_maskz_permutexvar_epi8(~__mmask64{0}, __m512i(places), __m512i(rows));
    blendBytes(quads, __m512i(shares.across), __m512i(shares.down), sum);
  }

  CARTVO_BYTE_SHUFFLES static void blendQuads(const IntLanes& quads, const IntLanes& x, const IntLanes& y,
                                              IntLanes& sum) {
    const IntLanes across = Processor::shuffled<1, 1, 1, 1>(x) ^ kLeftBytes;
    const IntLanes down = IntLanes(_mm512_srli_epi16(__m512i(Processor::shuffled<0, 1, 0, 1>(y)), 3)) ^ kDown;
    blendBytes(__m512i(quads ^ kMiddleGrey), __m512i(across), __m512i(down), sum);
  }

  /// The same of pixels between the row that begins at `first` and the next.
  CARTVO_BYTE_SHUFFLES static void blendBetween(const std::uint8_t* first, std::ptrdiff_t stride,
                                                const IntLanes& x, int y, IntLanes& sum) {
    RowPair rows;
    load(first, stride, rows);
    const IntLanes places = Processor::shuffled<2, 2, 2, 2>(x) + Processor::kQuad;
    const __m512i quads = _mm512_maskz_permutexvar_epi8(~__mmask64{0}, __m512i(places), __m512i(rows));
    const IntLanes across = Processor::shuffled<1, 1, 1, 1>(x) ^ kLeftBytes;
    const int lower = y >> 3 & kDown;
    const IntLanes down = IntLanes{} + (lower << 16 | (kDown - lower));
    blendBytes(quads, __m512i(across), __m512i(down), sum);
  }

  CARTVO_BYTE_SHUFFLES static void store(const IntLanes& upper, const IntLanes& lower, std::int16_t* to) {
    _mm512_storeu_si512(to, upperHalves<kUnpadded>(upper, lower));
  }
  CARTVO_BYTE_SHUFFLES static void storeHalf(const IntLanes& upper, const IntLanes& lower, std::int16_t* to) {
    storeRounded<kUnpadded>(upper, lower, to);
  }
  CARTVO_BYTE_SHUFFLES static void storeHalfRow(const IntLanes& left, const IntLanes& right,
                                                std::int16_t* to) {
    storeRounded<~__mmask32{0}>(left, right, to);
  }

  template <int Values>
  CARTVO_BYTE_SHUFFLES static void multiply(const std::int16_t* a, const std::int16_t* b,
                                            std::int16_t* product) {
    static_assert(Values % kShorts == 0);
#pragma GCC unroll 4
    for (int i = 0; i < Values; i += kShorts)
      _mm512_storeu_si512(product + i,
                          _mm512_mulhrs_epi16(_mm512_loadu_si512(a + i), _mm512_loadu_si512(b + i)));
  }

  template <int Count, int Values, typename Left, typename Right>
  CARTVO_BYTE_SHUFFLES static void sumProducts(const Left& left, const Right& right, std::int32_t* sums) {
    static_assert(Values % kShorts == 0 && Count <= kMostSums && Count % 4 == 0);
    __m512i sum[kMostSums] = {};
#pragma GCC unroll 4
    for (int k = 0; k < Values; k += kShorts) {
#pragma GCC unroll 16
      for (int i = 0; i < Count; ++i)
        sum[i] =
            _mm512_dpwssd_epi32(sum[i], _mm512_loadu_si512(left(i) + k), _mm512_loadu_si512(right(i) + k));
    }
    // Two at a time, so that each of their sixteen numbers is added to others at the same cost.
#pragma GCC unroll 8
    for (int i = 0; i < Count; i += 2)
      sum[i] = _mm512_add_epi32(_mm512_maskz_unpacklo_epi32(0xffff, sum[i], sum[i + 1]),
                                _mm512_maskz_unpackhi_epi32(0xffff, sum[i], sum[i + 1]));
#pragma GCC unroll 4
    for (int i = 0; i < Count; i += 4)
      sum[i] = _mm512_add_epi32(_mm512_maskz_unpacklo_epi64(0xff, sum[i], sum[i + 2]),
                                _mm512_maskz_unpackhi_epi64(0xff, sum[i], sum[i + 2]));
#pragma GCC unroll 2
    for (int i = 0; i < Count; i += 8)
      addQuarters(sum[i], sum[i + 4]);
    addQuarters(sum[0], sum[8]);
    constexpr auto kWanted = static_cast<__mmask16>((1U << Count) - 1);
    _mm512_mask_storeu_epi32(sums, kWanted, sum[0]);
  }

  template <int Count, int Rows, int Stride>
  CARTVO_BYTE_SHUFFLES static void sumWindows(const std::int16_t* window, const std::int16_t* others,
                                              WindowSums& products, WindowSums& values, WindowSums& squares) {
    static_assert(Count < kMostWindows);
    const __m256i ones = _mm256_set1_epi16(1);
    constexpr __mmask16 kPatch = 0x7fff;
    __m256i product[kMostWindows] = {}, value[kMostWindows] = {}, square[kMostWindows] = {};
#pragma GCC unroll 16
    for (int y = 0; y < Rows; ++y) {
      const __m256i row = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(window + y * kLanes));
#pragma GCC unroll 8
      for (int i = 0; i < Count; ++i) {
        const __m256i other = _mm256_maskz_loadu_epi16(kPatch, others + y * Stride + i);
        product[i] = _mm256_dpwssd_epi32(product[i], row, other);
        value[i] = _mm256_dpwssd_epi32(value[i], ones, other);
        square[i] = _mm256_dpwssd_epi32(square[i], other, other);
      }
    }
    fold(product, products);
    fold(value, values);
    fold(square, squares);
  }

 private:
  static constexpr int kShorts = 2 * kLanes;
  static constexpr int kMostSums = 16;
  static constexpr __mmask32 kUnpadded = 0x7fff7fff;
  static constexpr int kMiddleGrey = static_cast<int>(0x80808080);
  static constexpr int kLeftBytes = 0x00ff00ff;

  CARTVO_BYTE_SHUFFLES static void blendBytes(const __m512i& quads, const __m512i& across,
                                              const __m512i& down, IntLanes& sum) {
    sum = IntLanes(_mm512_madd_epi16(_mm512_maddubs_epi16(across, quads), down));
  }
  template <__mmask32 Kept>
  CARTVO_BYTE_SHUFFLES static void storeRounded(const IntLanes& first, const IntLanes& second,
                                                std::int16_t* to) {
    const __m512i rounded = upperHalves<Kept>(first + 65536, second + 65536);
    _mm512_storeu_si512(to, _mm512_srai_epi16(rounded, 1));
  }
  /// Of two rows.
  template <__mmask32 Kept>
  CARTVO_BYTE_SHUFFLES static __m512i upperHalves(const IntLanes& upper, const IntLanes& lower) {
    const IntLanes column = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    // Of two numbers each, the lower half of a lane first.
    const IntLanes even = (column & 7) * 4 + (column >> 3) * 32;
    const __m512i places = __m512i((even + 3) << 16 | (even + 1));
    return _mm512_maskz_permutex2var_epi16(Kept, __m512i(upper), places, __m512i(lower));
  }
  CARTVO_BYTE_SHUFFLES static void fold(__m256i (&sum)[kMostWindows], WindowSums& sums) {
#pragma GCC unroll 4
    for (int i = 0; i < kMostWindows; i += 2)
      sum[i] = _mm256_add_epi32(_mm256_unpacklo_epi32(sum[i], sum[i + 1]),
                                _mm256_unpackhi_epi32(sum[i], sum[i + 1]));
#pragma GCC unroll 2
    for (int i = 0; i < kMostWindows; i += 4)
      sum[i] = _mm256_add_epi32(_mm256_unpacklo_epi64(sum[i], sum[i + 2]),
                                _mm256_unpackhi_epi64(sum[i], sum[i + 2]));
    constexpr int kLower = 0x20, kUpper = 0x31;
    sums = WindowSums(_mm256_add_epi32(_mm256_permute2x128_si256(sum[0], sum[4], kLower),
                                       _mm256_permute2x128_si256(sum[0], sum[4], kUpper)));
  }
  /// a + its other quarters beside b + its own, first the lower ones.
  CARTVO_BYTE_SHUFFLES static void addQuarters(__m512i& a, const __m512i& b) {
    constexpr int kEven = 0b10'00'10'00, kOdd = 0b11'01'11'01;
    a = _mm512_add_epi32(_mm512_maskz_shuffle_i32x4(0xffff, a, b, kEven),
                         _mm512_maskz_shuffle_i32x4(0xffff, a, b, kOdd));
  }
};
#endif

}  // namespace cartvo
