#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "vo_core/lanes.hpp"

// Bilinear interpolation of sixteen pixels at any places: for each, a quad of four bytes.

namespace cartvo {

/// Of sixteen pixels the bytes at them, right of them, below them and below to the right, lowest first.
/// `offset`: of the pixels from `corner`; only the first `count` are read.
inline void fetchQuadsOneByOne(const std::uint8_t* corner, std::ptrdiff_t stride, const IntLanes& offset,
                               int count, IntLanes& quads) {
  alignas(64) std::int32_t from[kLanes];
  alignas(64) std::uint32_t fetched[kLanes] = {};
  std::memcpy(from, &offset, sizeof from);
  for (int x = 0; x < count; ++x) {
    std::uint16_t above, below;
    std::memcpy(&above, corner + from[x], sizeof above);
    std::memcpy(&below, corner + from[x] + stride, sizeof below);
    fetched[x] = above | static_cast<std::uint32_t>(below) << 16;
    asm volatile("");  // Else the compiler gathers into registers first, which takes four times as long.
  }
  std::memcpy(&quads, fetched, sizeof quads);
}

/// Between the four pixels of each quad, times 65536, exactly. `fraction_x`: 1/256 px, twice in each number,
/// as Processor::secondBytes() has it; `y` as Processor::blendRows() does.
template <typename Processor>
void blendQuads(const IntLanes& quads, const IntLanes& fraction_x, const IntLanes& y, IntLanes& sum) {
  // Of each quad a pair: above and below.
  const IntLanes left_bytes = quads & 0x00ff00ff;
  const WideShorts &both = reinterpret_cast<const WideShorts&>(quads),
                   &left = reinterpret_cast<const WideShorts&>(left_bytes);
  const WideShorts between =
      (both << 8) + reinterpret_cast<const WideShorts&>(fraction_x) * ((both >> 8) - left);  // modulo 2^16
  Processor::blendRows(reinterpret_cast<const IntLanes&>(between), y, sum);
}

}  // namespace cartvo
