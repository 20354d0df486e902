#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "vo_core/simd/target_clones.hpp"

#ifdef CARTVO_BYTE_SHUFFLES
#include <immintrin.h>
#endif

namespace cartvo::vo {

/// Sixteen numbers that are processed at once by the vector extension of GCC and Clang: one AVX-512 register,
/// two of AVX or four of SSE or NEON. Never passed by value, because that ABI depends on the processor.
constexpr int kLanes = 16;
using IntLanes = std::int32_t __attribute__((vector_size(4 * kLanes), may_alias));
using ShortLanes = std::uint16_t __attribute__((vector_size(2 * kLanes), may_alias));
using ByteLanes = std::uint8_t __attribute__((vector_size(kLanes), may_alias));
/// 32 numbers in one AVX-512 register.
using WideShorts = std::uint16_t __attribute__((vector_size(4 * kLanes), may_alias));

/// Operations that are implemented per processor because that is faster. All implementations give the same
/// bits.
struct AnyProcessor {
  static constexpr bool kShufflesBytes = false;
  static void load(const std::uint8_t* from, ShortLanes& to) {
    ByteLanes bytes;
    std::memcpy(&bytes, from, sizeof bytes);
    to = __builtin_convertvector(bytes, ShortLanes);
  }
  /// Interpolates between an upper number, the lower half of `pairs`, and a lower one, the upper half; the
  /// result is 256-fold. `y` is in 1/65536 px: its second lowest byte is the weight of the lower number.
  static void blendRows(const IntLanes& pairs, const IntLanes& y, IntLanes& sum) {
    const IntLanes upper = pairs & 0xffff, lower = pairs >> 16 & 0xffff;
    sum = (upper << 8) + (y >> 8 & 0xff) * (lower - upper);
  }
  static void storeBytes(const IntLanes& from, std::uint8_t* to) {
    const ByteLanes bytes = __builtin_convertvector(__builtin_convertvector(from, ShortLanes), ByteLanes);
    std::memcpy(to, &bytes, sizeof bytes);
  }
};

#ifdef CARTVO_BYTE_SHUFFLES
/// AVX-512 with VBMI, which selects any 64 of 128 bytes at once. GCC 12 widens sixteen numbers in halves and
/// joins them again. Masked intrinsics with a full mask, because GCC 12 warns about its own unmasked ones.
struct ByteShufflingProcessor {
  static constexpr bool kShufflesBytes = true;
  CARTVO_BYTE_SHUFFLES static void load(const std::uint8_t* from, ShortLanes& to) {
    to = ShortLanes(_mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from))));
  }
  /// Gathers the 2x2 neighbourhoods of sixteen pixels (the bytes at the pixel, right of it, below it and
  /// below to the right, lowest first) out of four rows of 32 pixels that begin at `first`. `place`: row
  /// times 32 plus column, at most 94.
  CARTVO_BYTE_SHUFFLES static void gather2x2(const std::uint8_t* first, std::ptrdiff_t stride,
                                             const IntLanes& place, IntLanes& neighbours) {
    const __m512i upper = rowPair(first, first + stride);
    const __m512i lower = rowPair(first + 2 * stride, first + 3 * stride);
    const IntLanes places = shuffled<0, 0, 0, 0>(place) + k2x2Offsets;
    neighbours = IntLanes(_mm512_permutex2var_epi8(upper, __m512i(places), lower));
  }
  CARTVO_BYTE_SHUFFLES static void blendRows(const IntLanes& pairs, const IntLanes& y, IntLanes& sum) {
    const IntLanes lower_share = shuffled<1, kZero, 1, kZero>(y);
    // The weight of the upper number is the rest of 256: 65535 less the lower weight, plus 257.
    const __m512i shares = _mm512_add_epi16(__m512i(lower_share ^ 0xffff), _mm512_set1_epi32(257));
    // The instruction multiplies signed numbers: positive ones are lowered for it, in both halves.
    const IntLanes less = pairs ^ static_cast<std::int32_t>(0x80008000);
    sum = IntLanes(_mm512_madd_epi16(__m512i(less), shares)) + 256 * 32768;
  }
  /// 32 pixels of a row, followed by 32 of another.
  CARTVO_BYTE_SHUFFLES static __m512i rowPair(const std::uint8_t* first, const std::uint8_t* second) {
    const __m256i low = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(first));
    const __m256i high = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(second));
    return _mm512_maskz_inserti64x4(0xff, _mm512_castsi256_si512(low), high, 1);
  }
  /// Offsets from a pixel to its 2x2 neighbourhood, in two rows of which one follows the other.
  static constexpr int k2x2Offsets = 33 << 24 | 32 << 16 | 1 << 8;
  /// Four bytes of each number, selected by their indices in it, the lowest first.
  template <int A, int B, int C, int D>
  CARTVO_BYTE_SHUFFLES static IntLanes shuffled(const IntLanes& from) {
    constexpr int kPattern = static_cast<int>(std::uint32_t{D} << 24 | C << 16 | B << 8 | A);
    // One instruction shuffles four numbers together, so that the bytes of each have their own indices.
    const IntLanes number = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    const IntLanes places = number * 0x04040404 + kPattern;
    return IntLanes(_mm512_maskz_shuffle_epi8(~__mmask64{0}, __m512i(from), __m512i(places)));
  }
  CARTVO_BYTE_SHUFFLES static bool allBelow(const ShortLanes& lanes, std::uint16_t bound) {
    return _mm256_cmplt_epu16_mask(__m256i(lanes), _mm256_set1_epi16(static_cast<short>(bound))) == 0xffff;
  }
  /// Stores the lowest bytes of sixteen numbers.
  CARTVO_BYTE_SHUFFLES static void storeBytes(const IntLanes& from, std::uint8_t* to) {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to), _mm512_maskz_cvtepi32_epi8(0xffff, __m512i(from)));
  }

 private:
  static constexpr int kZero = 0x80;
};

inline bool shufflesBytes() {
  static const bool supported = __builtin_cpu_supports("x86-64-v4") != 0 &&
                                __builtin_cpu_supports("avx512vbmi") != 0 &&
                                __builtin_cpu_supports("avx512vnni") != 0;
  return supported;
}
#endif

}  // namespace cartvo::vo

// Defines name(parameters) as implementation<Processor>(arguments), a function template, compiled for each
// kind of processor and selected once at run time. Parameters and arguments are in parentheses.
#ifdef CARTVO_BYTE_SHUFFLES
#define CARTVO_BY_PROCESSOR(Result, name, parameters, arguments, implementation)                  \
  CARTVO_TARGET_CLONES Result name##Anywhere parameters {                                         \
    return implementation<::cartvo::vo::AnyProcessor> arguments;                                  \
  }                                                                                               \
  CARTVO_BYTE_SHUFFLES Result name##ByShuffles parameters {                                       \
    return implementation<::cartvo::vo::ByteShufflingProcessor> arguments;                        \
  }                                                                                               \
  Result name parameters {                                                                        \
    return ::cartvo::vo::shufflesBytes() ? name##ByShuffles arguments : name##Anywhere arguments; \
  }
#else
#define CARTVO_BY_PROCESSOR(Result, name, parameters, arguments, implementation) \
  Result name parameters {                                                       \
    return implementation<::cartvo::vo::AnyProcessor> arguments;                 \
  }
#endif
