// The minimum distance between features.
#include "vo_core/spacing_grid.hpp"

#include <cmath>

namespace cartvo {

void SpacingGrid::reset(int width, int height, double distance) {
  distance_ = distance;
  cells_per_pixel_ = std::sqrt(2.0) / distance;  // a cell's diagonal is the distance
  columns_ = static_cast<int>(width * cells_per_pixel_) + 1;
  rows_ = static_cast<int>(height * cells_per_pixel_) + 1;
  stride_ = columns_ + 2 * kReach;
  cells_.assign(static_cast<std::size_t>(stride_) * (rows_ + 2 * kReach), kEmpty);
  points_.clear();
  points_.reserve(static_cast<std::size_t>(columns_) * rows_);
}

bool SpacingGrid::tooClose(const std::int32_t* cell, const Eigen::Vector2d& point) const {
  for (int row = -kReach; row <= kReach; ++row) {
    const std::int32_t* cells = cell + row * stride_;
    if ((cells[-2] & cells[-1] & cells[0] & cells[1] & cells[2]) == kEmpty) continue;  // most are
    for (int column = -kReach; column <= kReach; ++column)
      if (cells[column] != kEmpty &&
          (points_[static_cast<std::size_t>(cells[column])] - point).squaredNorm() < distance_ * distance_)
        return true;
  }
  return false;
}

bool SpacingGrid::insert(const Eigen::Vector2d& point) {
  if (point.x() < 0.0 || point.y() < 0.0) return false;
  const int column = static_cast<int>(point.x() * cells_per_pixel_);
  const int row = static_cast<int>(point.y() * cells_per_pixel_);
  if (column >= columns_ || row >= rows_) return false;
  std::int32_t* cell = &cells_[static_cast<std::size_t>(row + kReach) * stride_ + column + kReach];
  if (tooClose(cell, point)) return false;
  *cell = static_cast<std::int32_t>(points_.size());
  points_.push_back(point);
  return true;
}

}  // namespace cartvo
