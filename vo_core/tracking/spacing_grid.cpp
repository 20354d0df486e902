// Grid that keeps features a minimum distance apart.
#include "vo_core/tracking/spacing_grid.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace cartvo::vo {
namespace {

constexpr float kEmptyCell = -1e6F;  // px, coordinate of an empty cell

constexpr int kFloats = 4;  // a register of any processor
using Floats = float __attribute__((vector_size(4 * kFloats)));
using Mask = std::int32_t __attribute__((vector_size(4 * kFloats)));

/// First cells, relative to the point's own, of runs of kFloats cells. Together they cover all cells within
/// the minimum distance, which is the diagonal of a cell: five rows without their corners.
struct Run {
  int row, column;
};
constexpr Run kRuns[] = {{-2, -1}, {-1, -2}, {-1, -1}, {0, -2}, {0, -1}, {1, -2}, {1, -1}, {2, -1}};

}  // namespace

void SpacingGrid::reset(int width, int height, double distance) {
  square_distance_ = static_cast<float>(distance * distance);
  cells_per_pixel_ = std::sqrt(2.0) / distance;
  columns_ = static_cast<int>(width * cells_per_pixel_) + 1;
  rows_ = static_cast<int>(height * cells_per_pixel_) + 1;
  stride_ = columns_ + 2 * kReach;
  const std::size_t cells = static_cast<std::size_t>(stride_) * (rows_ + 2 * kReach);
  x_.assign(cells, kEmptyCell);
  y_.assign(cells, kEmptyCell);
}

bool SpacingGrid::tooClose(std::ptrdiff_t cell, float x, float y) const {
  if (x_[cell] != kEmptyCell) return true;
  Mask close{};
#pragma GCC unroll 8
  for (const Run& run : kRuns) {
    const std::ptrdiff_t first = cell + run.row * stride_ + run.column;
    Floats across, down;
    std::memcpy(&across, x_.data() + first, sizeof across);
    std::memcpy(&down, y_.data() + first, sizeof down);
    across -= x;
    down -= y;
    close |= across * across + down * down < square_distance_;
  }
  std::uint64_t halves[2];
  std::memcpy(halves, &close, sizeof halves);
  return (halves[0] | halves[1]) != 0;
}

bool SpacingGrid::insert(const Eigen::Vector2d& point) {
  if (point.x() < 0.0 || point.y() < 0.0) return false;
  const int column = static_cast<int>(point.x() * cells_per_pixel_);
  const int row = static_cast<int>(point.y() * cells_per_pixel_);
  if (column >= columns_ || row >= rows_) return false;
  const std::ptrdiff_t cell = (row + kReach) * stride_ + column + kReach;
  const auto x = static_cast<float>(point.x()), y = static_cast<float>(point.y());
  if (tooClose(cell, x, y)) return false;
  x_[cell] = x;
  y_[cell] = y;
  return true;
}

}  // namespace cartvo::vo
