#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace cartvo {

/// Keeps points of an image a minimum distance apart: each is let in only if none is closer already.
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
  static constexpr std::int32_t kEmpty = -1;

  bool tooClose(const std::int32_t* cell, const Eigen::Vector2d& point) const;

  int columns_ = 0, rows_ = 0;
  int stride_ = 0;  ///< cells in a row, with kReach empty ones on each side
  double distance_ = 0.0, cells_per_pixel_ = 0.0;
  std::vector<std::int32_t> cells_;  ///< so small that each holds one point at most: its place in points_
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace cartvo
