// The minimum distance between features.
#include "vo_core/spacing_grid.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {

SpacingGrid::SpacingGrid(int width, int height, double distance)
    : columns_(0), rows_(0), distance_(distance), cell_(distance / std::sqrt(2.0)) {
  columns_ = static_cast<int>(width / cell_) + 1;
  rows_ = static_cast<int>(height / cell_) + 1;
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
}

bool SpacingGrid::insert(const Eigen::Vector2d& point) {
  const int column = static_cast<int>(std::floor(point.x() / cell_));
  const int row = static_cast<int>(std::floor(point.y() / cell_));
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return false;
  for (int y = std::max(row - 2, 0); y <= std::min(row + 2, rows_ - 1); ++y) {
    for (int x = std::max(column - 2, 0); x <= std::min(column + 2, columns_ - 1); ++x) {
      const auto& other = cells_[static_cast<std::size_t>(y) * columns_ + x];
      if (other && (*other - point).squaredNorm() < distance_ * distance_) return false;
    }
  }
  cells_[static_cast<std::size_t>(row) * columns_ + column] = point;
  return true;
}

}  // namespace cartvo
