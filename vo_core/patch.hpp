#pragma once

#include <Eigen/Core>
#include <cmath>

#include "vo_core/image_pyramid.hpp"

// The inner loops of tracking are compiled twice, for any x86-64 and for AVX2; which one runs is found out at
// the start. What they call is inlined (flatten), else it would stay as it is. Both do the same operations in
// the same order (sums have fixed lanes, and without FMA nothing is contracted), so that the results are the
// same bits. Sanitizers cannot stand the choice at start.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CARTVO_VECTOR_CLONES __attribute__((flatten, target_clones("avx2", "default")))
#else
#define CARTVO_VECTOR_CLONES
#endif

namespace cartvo {

/// A small window of grey values around a sub-pixel centre. Rows are padded to a multiple of four so that the
/// compiler turns loops over them into vector instructions; the padding is read from the image as well.
template <int Columns, int Rows>
struct Patch {
  static constexpr int kColumns = Columns;
  static constexpr int kRows = Rows;
  static constexpr int kStride = (Columns + 3) / 4 * 4;
  alignas(64) float value[Rows * kStride];

  const float* row(int y) const { return value + y * kStride; }
  float* row(int y) { return value + y * kStride; }
};

/// Sum over the window of a times b. The compiler may not reorder sums of floats by itself: there is a sum
/// for each of eight lanes, added up at the end. The padding must be zero in one of the two.
template <int Columns, int Rows>
double sumOfProducts(const Patch<Columns, Rows>& a, const Patch<Columns, Rows>& b) {
  constexpr int kLanes = 8;
  constexpr int kSize = Rows * Patch<Columns, Rows>::kStride;
  static_assert(kSize % kLanes == 0);
  float lane[kLanes] = {};
  for (int i = 0; i < kSize; i += kLanes)
    for (int j = 0; j < kLanes; ++j)
      lane[j] += a.value[i + j] * b.value[i + j];
  double sum = 0.0;
  for (const float part : lane)
    sum += part;
  return sum;
}

/// Makes the window's mean zero, and its padding.
template <int Columns, int Rows>
void removeMean(Patch<Columns, Rows>& patch) {
  using P = Patch<Columns, Rows>;
  float column_sum[P::kStride] = {};
  for (int y = 0; y < Rows; ++y)
    for (int x = 0; x < P::kStride; ++x)
      column_sum[x] += patch.row(y)[x];
  float sum = 0.0F;
  for (int x = 0; x < Columns; ++x)
    sum += column_sum[x];
  const float mean = sum / (Columns * Rows);
  for (int y = 0; y < Rows; ++y) {
    for (int x = 0; x < P::kStride; ++x)
      patch.row(y)[x] -= mean;
    for (int x = Columns; x < P::kStride; ++x)
      patch.row(y)[x] = 0.0F;
  }
}

/// Samples the patch around `centre`, which must lie inside the level, by bilinear interpolation. Columns and
/// rows must be odd.
template <int Columns, int Rows>
void samplePatch(const PyramidLevel& level, const Eigen::Vector2d& centre, Patch<Columns, Rows>& patch) {
  using P = Patch<Columns, Rows>;
  static_assert(P::kStride - Columns / 2 < PyramidLevel::kBorder && Rows / 2 + 1 < PyramidLevel::kBorder);
  const double floor_x = std::floor(centre.x());
  const double floor_y = std::floor(centre.y());
  const float fx = static_cast<float>(centre.x() - floor_x);
  const float fy = static_cast<float>(centre.y() - floor_y);
  const int left = static_cast<int>(floor_x) - Columns / 2;
  const int top = static_cast<int>(floor_y) - Rows / 2;

  float upper[P::kStride];
  float lower[P::kStride];
  const auto interpolate_row = [&](int y, float* out) {
    const float* source = level.at<float>(left, y);
    for (int x = 0; x < P::kStride; ++x)
      out[x] = source[x] + fx * (source[x + 1] - source[x]);
  };
  interpolate_row(top, upper);
  for (int y = 0; y < Rows; ++y) {
    interpolate_row(top + y + 1, lower);
    float* out = patch.row(y);
    for (int x = 0; x < P::kStride; ++x) {
      out[x] = upper[x] + fy * (lower[x] - upper[x]);
      upper[x] = lower[x];
    }
  }
}

}  // namespace cartvo
