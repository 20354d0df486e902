#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace cartvo {

/// Keeps points of an image a minimum distance apart: each is let in only if none is closer already.
class SpacingGrid {
 public:
  /// Sizes and distance in px.
  SpacingGrid(int width, int height, double distance);

  /// Whether the point was let in. Points outside the image never are.
  bool insert(const Eigen::Vector2d& point);

 private:
  int columns_, rows_;
  double distance_, cell_;
  std::vector<std::optional<Eigen::Vector2d>> cells_;  // so small that a cell holds one point at most
};

}  // namespace cartvo
