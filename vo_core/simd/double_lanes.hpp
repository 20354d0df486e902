#pragma once

#include <cmath>
#include <cstdint>

#include "common/simd/target_clones.hpp"

namespace cartvo::vo {

/// Four doubles that are processed at once, like Lanes; normal equations need double precision. Four fill an
/// AVX2 register. Eight would fill one of AVX-512, but GCC 12 moves those through memory, which costs three
/// times as much as they save here. Never passed or returned by value, because that ABI depends on the
/// processor. The alignment is specified, because its default depends on the processor, too.
constexpr int kDoubleLanes = 4;
using DoubleLanes =
    double __attribute__((vector_size(8 * kDoubleLanes), aligned(8 * kDoubleLanes), may_alias));

/// Masks as unsigned integers. GCC 12 compares and selects lane by lane where the lanes do not fit into one
/// register; with bit operations it does not.
using BitLanes =
    std::uint64_t __attribute__((vector_size(8 * kDoubleLanes), aligned(8 * kDoubleLanes), may_alias));

/// Masks as comparisons return them: all bits set where true, else none. Only for few comparisons: they may
/// be slower than BitLanes where the lanes do not fit into one register.
using MaskLanes =
    std::int64_t __attribute__((vector_size(8 * kDoubleLanes), aligned(8 * kDoubleLanes), may_alias));

inline bool any(const MaskLanes& mask) {
  return ((mask[0] | mask[1]) | (mask[2] | mask[3])) != 0;
}

/// Sets `where` to all bits where a number is negative, else none.
inline void findNegative(const DoubleLanes& numbers, BitLanes& where) {
  where = -(reinterpret_cast<const BitLanes&>(numbers) >> 63);
}
/// Sets the numbers outside `where` to zero.
inline void keepWhere(const BitLanes& where, DoubleLanes& numbers) {
  reinterpret_cast<BitLanes&>(numbers) &= where;
}
/// Sets `ones` to 1 inside `where`, 0 outside.
inline void onesWhere(const BitLanes& where, DoubleLanes& ones) {
  ones = 1.0 + DoubleLanes{};
  keepWhere(where, ones);
}
/// Clamps the numbers to at least `least`.
inline void clampToMinimum(double least, DoubleLanes& numbers) {
  BitLanes below;
  findNegative(numbers - least, below);
  DoubleLanes floor = least + DoubleLanes{};
  keepWhere(below, floor);
  keepWhere(~below, numbers);
  numbers += floor;
}

/// Replaces the numbers by their square roots.
inline void replaceBySquareRoots(DoubleLanes& numbers) {
  for (int i = 0; i < kDoubleLanes; ++i)
    numbers[i] = std::sqrt(numbers[i]);
}

/// Sum of the lanes, added in an order that is the same on each processor.
inline double sumOf(const DoubleLanes& lanes) {
  return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
}

/// Transposes four rows: the i-th number of each row becomes the i-th column, lane by lane.
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

/// Six numbers per lane: derivatives by a pose.
struct PoseLanes {
  DoubleLanes value[6];
};

}  // namespace cartvo::vo
