#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "vo_core/lanes.hpp"
#include "vo_core/patch.hpp"

namespace cartvo {

/// Of sixteen pixels the bytes at them, right of them, below them and below to the right, lowest first.
/// `offset`: of the pixels from `corner`; only the first `count` are read.
inline void fetchQuads(const std::uint8_t* corner, std::ptrdiff_t stride, const IntLanes& offset, int count,
                       IntLanes& quads) {
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

/// Between four pixels each, by bilinear interpolation.
inline void interpolateQuads(const IntLanes& quads, const Lanes& fraction_x, const Lanes& fraction_y,
                             Lanes& out) {
  const Lanes above_left = __builtin_convertvector(quads & 0xff, Lanes);
  const Lanes above_right = __builtin_convertvector(quads >> 8 & 0xff, Lanes);
  const Lanes below_left = __builtin_convertvector(quads >> 16 & 0xff, Lanes);
  const Lanes below_right = __builtin_convertvector(quads >> 24 & 0xff, Lanes);
  const Lanes top = above_left + fraction_x * (above_right - above_left);
  const Lanes bottom = below_left + fraction_x * (below_right - below_left);
  out = top + fraction_y * (bottom - top);
}

/// Samples the window around `position`, which must lie inside the level, under a warp from offsets in the
/// window to offsets in the level, by bilinear interpolation in floating point. Of the window's Side rows the
/// first and each RowStep-th after it are kept. No element of the warp may reach more than the level's
/// border.
template <typename Processor, int RowStep, int Side, int Rows>
void sampleWarped(const PyramidLevel& level, const Eigen::Vector2d& position, const Eigen::Matrix2d& warp_by,
                  Patch<Side, Rows>& out) {
  static_assert(Patch<Side, Rows>::kBlocks == 1, "a row is one vector of lanes");
  constexpr int kHalf = Side / 2;
  // Counted from a pixel left of and above all that is read: positive numbers are rounded down when
  // converted.
  constexpr int kBias = PyramidLevel::kBorder;
  const int centre_x = static_cast<int>(std::floor(position.x()));
  const int centre_y = static_cast<int>(std::floor(position.y()));
  const Eigen::Vector2f fraction =
      (position - Eigen::Vector2d(centre_x, centre_y)).cast<float>().array() + kBias;
  const Eigen::Matrix2f warp = warp_by.cast<float>();
  const std::ptrdiff_t stride = level.stride();
  const std::uint8_t* const corner = level.at(centre_x, centre_y) - kBias * stride - kBias;
  const float row_step = static_cast<float>(stride);
  const Lanes x = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

  for (int y = 0; y < Rows; ++y) {
    const Eigen::Vector2f start =
        fraction + warp * Eigen::Vector2f(-kHalf, static_cast<float>(RowStep * y - kHalf));
    const Lanes at_x = start.x() + warp(0, 0) * x;
    const Lanes at_y = start.y() + warp(1, 0) * x;
    const IntLanes columns = __builtin_convertvector(at_x, IntLanes);
    const IntLanes rows = __builtin_convertvector(at_y, IntLanes);
    const Lanes column = __builtin_convertvector(columns, Lanes);
    const Lanes row = __builtin_convertvector(rows, Lanes);
    IntLanes quads;
    const auto fetch = [&] {
      // Below 2^24, so that the product is exact.
      const IntLanes offset = __builtin_convertvector(row * row_step + column, IntLanes);
      fetchQuads(corner, stride, offset, Side, quads);
    };
    if constexpr (Processor::kShufflesBytes) {
      const int first = static_cast<int>(start.y());
      const int last = static_cast<int>(start.y() + warp(1, 0) * static_cast<float>(Side - 1));
      const int top = std::min(first, last), left = static_cast<int>(start.x());
      constexpr int kMostRows = 2;  // below the first
      if (std::max(first, last) - top <= kMostRows)
        Processor::fetchQuads(corner + top * stride + left, stride, ((rows - top) << 5) + (columns - left),
                              quads);
      else
        fetch();
    } else {
      fetch();
    }
    interpolateQuads(quads, at_x - column, at_y - row, out.lanes(y, 0));
  }
}

}  // namespace cartvo
