#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace cartvo {

/// Keeps points of an image a minimum distance apart: each is let in only if none is closer already. In
/// single precision: to a thousandth of a pixel in images of 8192.
class SpacingGrid {
 public:
  SpacingGrid() = default;
  /// Sizes and distance in px.
  SpacingGrid(int width, int height, double distance) { reset(width, height, distance); }

  /// Empty, for an image of that size, in the memory it has.
  void reset(int width, int height, double distance);

  /// Whether the point was let in. Points outside the image never are.
  bool insert(const Eigen::Vector2d& point);

 private:
  static constexpr int kReach = 2;  ///< cells away from a point's own, within which others may be too close

  bool tooClose(std::ptrdiff_t cell, float x, float y) const;

  int columns_ = 0, rows_ = 0;
  std::ptrdiff_t stride_ = 0;  ///< cells in a row, with kReach empty ones on each side
  double cells_per_pixel_ = 0.0;
  float square_distance_ = 0.0F;
  /// Each cell's point, px, or one far from all; so small are cells that they hold one at most.
  std::vector<float> x_, y_;
};

}  // namespace cartvo
