#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/simd/lanes.hpp"

// Gathers the 2x2 neighbourhoods from which pixels at arbitrary positions are interpolated.

namespace cartvo {

/// Gathers, for sixteen pixels, the bytes at the pixel, right of it, below it and below to the right, lowest
/// first. `offset`: of the pixels from `corner`; only the first `count` are read.
inline void gather2x2Scalar(const std::uint8_t* corner, std::ptrdiff_t stride, const IntLanes& offset,
                            int count, IntLanes& neighbours) {
  alignas(64) std::int32_t from[kLanes];
  alignas(64) std::uint32_t fetched[kLanes] = {};
  std::memcpy(from, &offset, sizeof from);
  for (int x = 0; x < count; ++x) {
    std::uint16_t above, below;
    std::memcpy(&above, corner + from[x], sizeof above);
    std::memcpy(&below, corner + from[x] + stride, sizeof below);
    fetched[x] = above | static_cast<std::uint32_t>(below) << 16;
    asm volatile("");  // else the compiler gathers into registers first, which takes four times as long
  }
  std::memcpy(&neighbours, fetched, sizeof neighbours);
}

}  // namespace cartvo
