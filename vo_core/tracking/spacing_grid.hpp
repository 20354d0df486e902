#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace cartvo::vo {

/// Keeps points of an image a minimum distance apart: insert() accepts a point only if no accepted one is
/// closer. Stores positions in single precision, which is a thousandth of a pixel in images of 8192 px.
class SpacingGrid {
 public:
  SpacingGrid() = default;
  /// Sizes and distance in px.
  SpacingGrid(int width, int height, double distance) { reset(width, height, distance); }

  /// Empties the grid for an image of that size; reuses its memory.
  void reset(int width, int height, double distance);

  /// Returns whether the point was accepted. Points outside the image are not.
  bool insert(const Eigen::Vector2d& point);

 private:
  static constexpr int kReach = 2;  ///< cells around a point's own within which others may be too close

  bool tooClose(std::ptrdiff_t cell, float x, float y) const;

  int columns_ = 0, rows_ = 0;
  std::ptrdiff_t stride_ = 0;  ///< cells in a row, with kReach empty ones on each side
  double cells_per_pixel_ = 0.0;
  float square_distance_ = 0.0F;
  /// Point of each cell, px, or a far one if it is empty. Cells are so small that they hold one point at
  /// most.
  std::vector<float> x_, y_;
};

}  // namespace cartvo::vo
