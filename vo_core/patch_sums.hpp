#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "vo_core/double_lanes.hpp"
#include "vo_core/image_pyramid.hpp"

// What is summed over patches, and how it gets into the equations of four of them. Not for use outside
// tracking.

namespace cartvo {

// What is asked of a patch: how far it has gone; in stereo how its columns have stretched and sheared, too;
// and then its rows.
constexpr int kShiftParameters = 2;   ///< x, y
constexpr int kStereoParameters = 4;  ///< and the warp's elements xx, xy
constexpr int kAffineParameters = 6;  ///< and yx, yy

/// Patches whose product is summed, by their places in a list.
struct Product {
  int a, b;
};

constexpr int wholeFours(int count) {
  return (count + 3) / 4 * 4;
}

/// The places of a template's sums. Its patches are the derivatives by the parameters, grey and ones.
template <int Parameters>
struct TemplateSums {
  static constexpr int kGrey = Parameters, kOnes = Parameters + 1;
  /// Of two derivatives, j <= i; of one; of one times grey.
  static constexpr int normal(int i, int j) { return i * (i + 1) / 2 + j; }
  static constexpr int slope(int i) { return normal(Parameters, 0) + i; }
  static constexpr int slopeGrey(int i) { return slope(Parameters) + i; }
  static constexpr int kGreys = slopeGrey(Parameters), kSquares = kGreys + 1;
  static constexpr int kCount = wholeFours(kSquares + 1);

  static constexpr std::array<Product, kCount> products() {
    std::array<Product, kCount> products{};
    for (int i = 0; i < Parameters; ++i) {
      for (int j = 0; j <= i; ++j)
        products[normal(i, j)] = {i, j};
      products[slope(i)] = {i, kOnes};
      products[slopeGrey(i)] = {i, kGrey};
    }
    products[kGreys] = {kGrey, kOnes};
    products[kSquares] = {kGrey, kGrey};
    return products;
  }
};

/// Those of a patch after, whose patches are the template's and then it.
template <int Parameters>
struct ComparisonSums {
  static constexpr int kGrey = Parameters, kOnes = Parameters + 1, kNow = Parameters + 2;
  /// Of it and a derivative.
  static constexpr int slope(int i) { return i; }
  static constexpr int kValues = Parameters, kSquares = kValues + 1, kWithGrey = kValues + 2;
  static constexpr int kCount = wholeFours(kWithGrey + 1);

  static constexpr std::array<Product, kCount> products() {
    std::array<Product, kCount> products{};
    for (int i = 0; i < Parameters; ++i)
      products[slope(i)] = {kNow, i};
    products[kValues] = {kNow, kOnes};
    products[kSquares] = {kNow, kNow};
    products[kWithGrey] = {kNow, kGrey};
    return products;
  }
};

/// Those of the shift that gradients ask for: of the patch after, to return, and of the template. The patches
/// are the gradients by x and y of the one and of the other, the patch after, grey and ones.
struct ReturnSums {
  static constexpr int kBackward = 0, kForward = 2, kNow = 4, kGrey = 5, kOnes = 6;
  /// From here on of the gradients: normal matrix, then times the patch after, times grey, and alone.
  static constexpr int kOfOne = 9;
  static constexpr int kXx = 0, kXy = 1, kYy = 2, kNows = 3, kGreys = 5, kAlone = 7;
  static constexpr int kCount = wholeFours(2 * kOfOne);

  static constexpr std::array<Product, kCount> products() {
    std::array<Product, kCount> products{};
    for (int side = 0; side < 2; ++side) {
      const int first = side * kOfOne, x = 2 * side, y = x + 1;
      products[first + kXx] = {x, x};
      products[first + kXy] = {x, y};
      products[first + kYy] = {y, y};
      for (int axis = 0; axis < 2; ++axis) {
        products[first + kNows + axis] = {x + axis, kNow};
        products[first + kGreys + axis] = {x + axis, kGrey};
        products[first + kAlone + axis] = {x + axis, kOnes};
      }
    }
    return products;
  }
};

template <typename Sums>
using SumsOfPatch = std::array<std::int32_t, Sums::kCount>;
/// A lane for each.
template <typename Sums>
struct SumsOfFour {
  DoubleLanes sum[Sums::kCount];

  const DoubleLanes& operator[](int place) const { return sum[place]; }
};

/// Each sum of four patches into lanes.
template <typename Sums>
void gatherLanes(const std::array<SumsOfPatch<Sums>, kDoubleLanes>& sums, SumsOfFour<Sums>& lanes) {
  using Ints = std::int32_t __attribute__((vector_size(4 * kDoubleLanes)));
  static_assert(Sums::kCount % kDoubleLanes == 0);
#pragma GCC unroll 16
  for (int i = 0; i < Sums::kCount; i += kDoubleLanes) {
    DoubleLanes rows[kDoubleLanes];
#pragma GCC unroll 4
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      Ints ints;
      std::memcpy(&ints, &sums[lane][i], sizeof ints);
      rows[lane] = __builtin_convertvector(ints, DoubleLanes);
    }
    transpose(rows, lanes.sum + i);
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
