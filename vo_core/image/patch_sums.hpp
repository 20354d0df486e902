#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "vo_core/image/image_pyramid.hpp"
#include "vo_core/simd/double_lanes.hpp"

// Sums over a patch, and their transposition into the equations of four patches. The template is the patch of
// the first image, the patch after that of the second. Internal to tracking.

namespace cartvo::vo {

// Numbers of parameters of a shift and of an affine warp.
constexpr int kShiftParameters = 2;   ///< x, y
constexpr int kAffineParameters = 6;  ///< and the warp's elements xx, xy, yx, yy

/// Two patches whose product is summed, by their indices in a list.
struct Product {
  int a, b;
};

constexpr int wholeFours(int count) {
  return (count + 3) / 4 * 4;
}

/// Indices of the sums of a template. Its patches are the derivatives by the parameters, the grey values, and
/// ones.
template <int Parameters>
struct TemplateSums {
  static constexpr int kGrey = Parameters, kOnes = Parameters + 1;
  /// Indices of the sums of derivative i times derivative j, j <= i; of derivative i; of derivative i times
  /// grey.
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

/// Indices of the sums of a patch after. Its patches are the template's, then the patch after.
template <int Parameters>
struct ComparisonSums {
  static constexpr int kGrey = Parameters, kOnes = Parameters + 1, kNow = Parameters + 2;
  /// Sum of the patch after times a derivative.
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

/// Indices of the sums for the forward-backward error: backward by the gradients of the patch after, forward
/// by those of the template. The patches are the gradients in x and y of the former and of the latter, the
/// patch after, the grey values, and ones.
struct ForwardBackwardSums {
  static constexpr int kBackward = 0, kForward = 2, kNow = 4, kGrey = 5, kOnes = 6;
  /// Sums of one direction: normal matrix, then the gradients times the patch after, times grey, and alone.
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
/// The sums of four patches, one SIMD lane each.
template <typename Sums>
struct SumsOfFour {
  DoubleLanes sum[Sums::kCount];

  const DoubleLanes& operator[](int place) const { return sum[place]; }
};

/// Transposes the sums of four patches into lanes.
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

/// Values of four patches, accessible as SIMD lanes and one by one.
struct alignas(DoubleLanes) LaneValues {
  double value[kDoubleLanes] = {};

  DoubleLanes& lanes() { return *reinterpret_cast<DoubleLanes*>(value); }
  const DoubleLanes& lanes() const { return *reinterpret_cast<const DoubleLanes*>(value); }
  void replace(const MaskLanes& where, const DoubleLanes& by) { lanes() = where ? by : lanes(); }
};

/// Bounds of the levels in which four patches are tracked: their last pixels.
struct LevelBounds {
  LaneValues right, bottom;  ///< px

  void set(std::size_t i, const PyramidLevel& level) {
    right.value[i] = level.width() - 1;
    bottom.value[i] = level.height() - 1;
  }
  /// Same limits as PyramidLevel::contains().
  void findInside(const LaneValues& x, const LaneValues& y, MaskLanes& inside) const {
    inside = (x.lanes() >= 0.0) & (y.lanes() >= 0.0) & (x.lanes() <= right.lanes()) &
             (y.lanes() <= bottom.lanes());
  }
};

}  // namespace cartvo::vo
