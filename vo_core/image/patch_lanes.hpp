#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "vo_core/image/aligned_patch.hpp"
#include "vo_core/simd/lanes.hpp"

// SIMD kernels on sixteen or more values of an AlignedPatch, specialised by processor, with bit-identical
// results. Internal to tracking and stereo matching.

namespace cartvo::vo {

/// Sub-pixel position of a patch's pixels: distance to the whole pixel to the left and above.
struct PixelFraction {
  int right = 0;  ///< in 1/kColumnSteps px
  int lower = 0;  ///< in 1/kRowSteps px
};

constexpr int kMaximumWindows = 8;  ///< windows that are compared at once
using WindowSums = std::int32_t __attribute__((vector_size(4 * kMaximumWindows), may_alias));

/// Kernels for any processor.
template <typename Processor>
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

#ifdef CARTVO_BYTE_SHUFFLES
/// Kernels for AVX-512 with VBMI and VNNI: one instruction blends four pixels horizontally, one vertically,
/// and one sums the products of 32 numbers. Masked intrinsics with a full mask, because GCC 12 warns about
/// its own unmasked ones.
template <>
class PatchLanes<ByteShufflingProcessor> {
 public:
  using Processor = ByteShufflingProcessor;
  using RowPair = IntLanes;
  struct Weights {
    IntLanes across, down;
  };

  CARTVO_BYTE_SHUFFLES static void setWeights(const PixelFraction& fraction, Weights& out) {
    out.across = IntLanes{} + (fraction.right * 0x01010101 ^ kLeftBytes);
    out.down = IntLanes{} + (fraction.lower << 16 | (kRowSteps - fraction.lower));
  }
  CARTVO_BYTE_SHUFFLES static void load(const std::uint8_t* first, std::ptrdiff_t stride, RowPair& rows) {
    rows = IntLanes(Processor::rowPair(first, first + stride)) ^ kMiddleGrey;
  }

  template <int Column>
  CARTVO_BYTE_SHUFFLES static void blend(const RowPair& rows, const Weights& weights, IntLanes& sum) {
    const IntLanes column = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const IntLanes places = (column + Column) * 0x01010101 + Processor::k2x2Offsets;
    const __m512i neighbours = _mm512_maskz_permutexvar_epi8(~__mmask64{0}, __m512i(places), __m512i(rows));
    blendBytes(neighbours, __m512i(weights.across), __m512i(weights.down), sum);
  }

  CARTVO_BYTE_SHUFFLES static void blendGathered(const IntLanes& neighbours, const IntLanes& x,
                                                 const IntLanes& y, IntLanes& sum) {
    const IntLanes across = Processor::shuffled<1, 1, 1, 1>(x) ^ kLeftBytes;
    const IntLanes down =
        IntLanes(_mm512_srli_epi16(__m512i(Processor::shuffled<0, 1, 0, 1>(y)), 3)) ^ kRowSteps;
    blendBytes(__m512i(neighbours ^ kMiddleGrey), __m512i(across), __m512i(down), sum);
  }

  /// Interpolates pixels between the row that begins at `first` and the next.
  CARTVO_BYTE_SHUFFLES static void blendBetween(const std::uint8_t* first, std::ptrdiff_t stride,
                                                const IntLanes& x, int y, IntLanes& sum) {
    RowPair rows;
    load(first, stride, rows);
    const IntLanes places = Processor::shuffled<2, 2, 2, 2>(x) + Processor::k2x2Offsets;
    const __m512i neighbours = _mm512_maskz_permutexvar_epi8(~__mmask64{0}, __m512i(places), __m512i(rows));
    const IntLanes across = Processor::shuffled<1, 1, 1, 1>(x) ^ kLeftBytes;
    const int lower = y >> 3 & kRowSteps;
    const IntLanes down = IntLanes{} + (lower << 16 | (kRowSteps - lower));
    blendBytes(neighbours, __m512i(across), __m512i(down), sum);
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
    static_assert(Values % kShorts == 0 && Count <= kMaximumSums && Count % 4 == 0);
    __m512i sum[kMaximumSums] = {};
#pragma GCC unroll 4
    for (int k = 0; k < Values; k += kShorts) {
#pragma GCC unroll 16
      for (int i = 0; i < Count; ++i)
        sum[i] =
            _mm512_dpwssd_epi32(sum[i], _mm512_loadu_si512(left(i) + k), _mm512_loadu_si512(right(i) + k));
    }
    // Reduces two sums at a time, at the cost of one.
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
    static_assert(Count < kMaximumWindows);
    const __m256i ones = _mm256_set1_epi16(1);
    constexpr __mmask16 kPatch = 0x7fff;
    __m256i product[kMaximumWindows] = {}, value[kMaximumWindows] = {}, square[kMaximumWindows] = {};
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
  static constexpr int kMaximumSums = 16;
  static constexpr __mmask32 kUnpadded = 0x7fff7fff;
  static constexpr int kMiddleGrey = static_cast<int>(0x80808080);
  static constexpr int kLeftBytes = 0x00ff00ff;

  CARTVO_BYTE_SHUFFLES static void blendBytes(const __m512i& neighbours, const __m512i& across,
                                              const __m512i& down, IntLanes& sum) {
    sum = IntLanes(_mm512_madd_epi16(_mm512_maddubs_epi16(across, neighbours), down));
  }
  template <__mmask32 Kept>
  CARTVO_BYTE_SHUFFLES static void storeRounded(const IntLanes& first, const IntLanes& second,
                                                std::int16_t* to) {
    const __m512i rounded = upperHalves<Kept>(first + 65536, second + 65536);
    _mm512_storeu_si512(to, _mm512_srai_epi16(rounded, 1));
  }
  /// Upper sixteen bits of the numbers of two rows, rounded down.
  template <__mmask32 Kept>
  CARTVO_BYTE_SHUFFLES static __m512i upperHalves(const IntLanes& upper, const IntLanes& lower) {
    const IntLanes column = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    // Two 16-bit indices per lane, the lower half first.
    const IntLanes even = (column & 7) * 4 + (column >> 3) * 32;
    const __m512i places = __m512i((even + 3) << 16 | (even + 1));
    return _mm512_maskz_permutex2var_epi16(Kept, __m512i(upper), places, __m512i(lower));
  }
  CARTVO_BYTE_SHUFFLES static void fold(__m256i (&sum)[kMaximumWindows], WindowSums& sums) {
#pragma GCC unroll 4
    for (int i = 0; i < kMaximumWindows; i += 2)
      sum[i] = _mm256_add_epi32(_mm256_unpacklo_epi32(sum[i], sum[i + 1]),
                                _mm256_unpackhi_epi32(sum[i], sum[i + 1]));
#pragma GCC unroll 2
    for (int i = 0; i < kMaximumWindows; i += 4)
      sum[i] = _mm256_add_epi32(_mm256_unpacklo_epi64(sum[i], sum[i + 2]),
                                _mm256_unpackhi_epi64(sum[i], sum[i + 2]));
    constexpr int kLower = 0x20, kUpper = 0x31;
    sums = WindowSums(_mm256_add_epi32(_mm256_permute2x128_si256(sum[0], sum[4], kLower),
                                       _mm256_permute2x128_si256(sum[0], sum[4], kUpper)));
  }
  /// Adds the quarters of a pairwise, and those of b; a receives both results, its own in the lower half.
  CARTVO_BYTE_SHUFFLES static void addQuarters(__m512i& a, const __m512i& b) {
    constexpr int kEven = 0b10'00'10'00, kOdd = 0b11'01'11'01;
    a = _mm512_add_epi32(_mm512_maskz_shuffle_i32x4(0xffff, a, b, kEven),
                         _mm512_maskz_shuffle_i32x4(0xffff, a, b, kOdd));
  }
};
#endif

}  // namespace cartvo::vo
