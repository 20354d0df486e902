#pragma once

#include <array>
#include <cstddef>
#include <cstring>

#include "vo_core/double_lanes.hpp"
#include "vo_core/image_pyramid.hpp"
#include "vo_core/lanes.hpp"

// How what is summed over a patch gets into the equations of four patches. Not for use outside tracking.

namespace cartvo {

// What is summed over a patch: first of each of its columns by itself, then of the patch, then of four
// patches, a lane each. All are lists of numbers and nothing else.
struct OfColumns {
  using Number = Lanes;
};
struct OfPatch {
  using Number = double;
};
struct OfFourPatches {
  using Number = DoubleLanes;
};

template <template <typename> typename Sums>
constexpr int kSumCount = static_cast<int>(sizeof(Sums<OfPatch>) / sizeof(double));

template <template <typename> typename Sums>
void foldColumns(const Sums<OfColumns>& columns, Sums<OfPatch>& sums) {
  static_assert(kSumCount<Sums> % 4 == 0);
  const Lanes* const from = reinterpret_cast<const Lanes*>(&columns);
  double* const to = reinterpret_cast<double*>(&sums);
#pragma GCC unroll 8
  for (int i = 0; i < kSumCount<Sums>; i += 4)
    sumsOf(from[i], from[i + 1], from[i + 2], from[i + 3], to + i);
}

template <template <typename> typename Sums>
void gatherLanes(const std::array<Sums<OfPatch>, kDoubleLanes>& sums, Sums<OfFourPatches>& lanes) {
  static_assert(kSumCount<Sums> % kDoubleLanes == 0);
  DoubleLanes* const to = reinterpret_cast<DoubleLanes*>(&lanes);
#pragma GCC unroll 8
  for (int i = 0; i < kSumCount<Sums>; i += kDoubleLanes) {
    DoubleLanes rows[kDoubleLanes];
#pragma GCC unroll 4
    for (int lane = 0; lane < kDoubleLanes; ++lane)
      std::memcpy(&rows[lane], reinterpret_cast<const double*>(&sums[lane]) + i, sizeof rows[lane]);
    transpose(rows, to + i);
  }
}

/// Numbers of four patches, to be read and written one by one as well.
struct alignas(DoubleLanes) Column {
  double value[kDoubleLanes] = {};

  DoubleLanes& lanes() { return *reinterpret_cast<DoubleLanes*>(value); }
  const DoubleLanes& lanes() const { return *reinterpret_cast<const DoubleLanes*>(value); }
  void replace(const MaskLanes& where, const DoubleLanes& by) { lanes() = where ? by : lanes(); }
};

/// The levels that four patches are looked for in, by their last pixels.
struct LevelBounds {
  Column right, bottom;  ///< px

  void set(std::size_t i, const PyramidLevel& level) {
    right.value[i] = level.width() - 1;
    bottom.value[i] = level.height() - 1;
  }
  /// As PyramidLevel::contains().
  void findInside(const Column& x, const Column& y, MaskLanes& inside) const {
    inside = (x.lanes() >= 0.0) & (y.lanes() >= 0.0) & (x.lanes() <= right.lanes()) &
             (y.lanes() <= bottom.lanes());
  }
};

}  // namespace cartvo
