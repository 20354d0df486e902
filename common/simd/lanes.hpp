#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/simd/target_clones.hpp"

namespace cartvo {

/// Sixteen numbers that are processed at once by the vector extension of GCC and Clang: one AVX-512 register,
/// two of AVX or four of SSE or NEON. Never passed by value, because that ABI depends on the processor.
constexpr int kLanes = 16;
using IntLanes = std::int32_t __attribute__((vector_size(4 * kLanes), may_alias));
using ShortLanes = std::uint16_t __attribute__((vector_size(2 * kLanes), may_alias));
using ByteLanes = std::uint8_t __attribute__((vector_size(kLanes), may_alias));
/// 32 numbers in one AVX-512 register.
using WideShorts = std::uint16_t __attribute__((vector_size(4 * kLanes), may_alias));

/// Operations on lanes.
struct LaneOperations {
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

}  // namespace cartvo
