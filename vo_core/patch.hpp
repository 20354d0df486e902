#pragma once

#include <Eigen/Core>
#include <cmath>

#include "vo_core/image_pyramid.hpp"

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
