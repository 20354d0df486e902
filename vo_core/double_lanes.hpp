#pragma once

#include <cstddef>

#include "vo_core/vector_clones.hpp"

namespace cartvo {

/// Eight numbers that are worked on at once, as Lanes of patch.hpp; of these, double: normal equations need
/// it. Never passed or returned by value alone, as how that is done depends on the processor; so would the
/// alignment, were it not given.
constexpr int kDoubleLanes = 8;
using DoubleLanes =
    double __attribute__((vector_size(8 * kDoubleLanes), aligned(8 * kDoubleLanes), may_alias));

/// In an order of its own, the same on each processor.
inline double sumOf(const DoubleLanes& lanes) {
  return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
}

/// So many blocks of lanes hold so many numbers.
constexpr std::size_t blocksFor(std::size_t numbers) {
  return (numbers + kDoubleLanes - 1) / kDoubleLanes;
}

/// Six numbers of each lane, as derivatives by a pose.
struct PoseLanes {
  DoubleLanes value[6];
};

}  // namespace cartvo
