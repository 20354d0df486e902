#pragma once

#include <cmath>
#include <cstdint>

#include "vo_core/vector_clones.hpp"

namespace cartvo {

/// Four numbers that are worked on at once, as Lanes are; of these, double: normal equations need it. Four
/// are a register of AVX2; eight, one of AVX-512, GCC 12 takes there through memory, which costs three times
/// as much as they save here. Never passed or returned by value alone, as how that is done depends on the
/// processor; so would the alignment, were it not given.
constexpr int kDoubleLanes = 4;
using DoubleLanes =
    double __attribute__((vector_size(8 * kDoubleLanes), aligned(8 * kDoubleLanes), may_alias));

/// GCC 12 compares and chooses lane by lane where they do not fit into one register; with bits it does not.
using BitLanes =
    std::uint64_t __attribute__((vector_size(8 * kDoubleLanes), aligned(8 * kDoubleLanes), may_alias));

/// As comparing gives it: all bits where it holds, else none. For a few comparisons, which need not be as
/// fast as bits are where they do not fit into one register.
using MaskLanes =
    std::int64_t __attribute__((vector_size(8 * kDoubleLanes), aligned(8 * kDoubleLanes), may_alias));

inline bool any(const MaskLanes& mask) {
  return ((mask[0] | mask[1]) | (mask[2] | mask[3])) != 0;
}

/// All bits where a number is negative, else none.
inline void findNegative(const DoubleLanes& numbers, BitLanes& where) {
  where = -(reinterpret_cast<const BitLanes&>(numbers) >> 63);
}
/// The numbers there, and zero elsewhere.
inline void keepWhere(const BitLanes& where, DoubleLanes& numbers) {
  reinterpret_cast<BitLanes&>(numbers) &= where;
}
/// 1 there, and 0 elsewhere.
inline void onesWhere(const BitLanes& where, DoubleLanes& ones) {
  ones = 1.0 + DoubleLanes{};
  keepWhere(where, ones);
}
/// The numbers, but at least so much.
inline void raiseTo(double least, DoubleLanes& numbers) {
  BitLanes below;
  findNegative(numbers - least, below);
  DoubleLanes floor = least + DoubleLanes{};
  keepWhere(below, floor);
  keepWhere(~below, numbers);
  numbers += floor;
}

inline void takeRoots(DoubleLanes& numbers) {
  for (int i = 0; i < kDoubleLanes; ++i)
    numbers[i] = std::sqrt(numbers[i]);
}

/// In an order of its own, the same on each processor.
inline double sumOf(const DoubleLanes& lanes) {
  return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
}

/// The i-th number of each row becomes lane by lane the i-th column.
inline void transpose(const DoubleLanes* rows, DoubleLanes* columns) {
  const DoubleLanes first = __builtin_shufflevector(rows[0], rows[1], 0, 4, 2, 6);
  const DoubleLanes second = __builtin_shufflevector(rows[0], rows[1], 1, 5, 3, 7);
  const DoubleLanes third = __builtin_shufflevector(rows[2], rows[3], 0, 4, 2, 6);
  const DoubleLanes fourth = __builtin_shufflevector(rows[2], rows[3], 1, 5, 3, 7);
  columns[0] = __builtin_shufflevector(first, third, 0, 1, 4, 5);
  columns[1] = __builtin_shufflevector(second, fourth, 0, 1, 4, 5);
  columns[2] = __builtin_shufflevector(first, third, 2, 3, 6, 7);
  columns[3] = __builtin_shufflevector(second, fourth, 2, 3, 6, 7);
}

/// Six numbers of each lane, as derivatives by a pose.
struct PoseLanes {
  DoubleLanes value[6];
};

}  // namespace cartvo
