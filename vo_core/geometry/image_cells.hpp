#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "vo_core/stereo_camera.hpp"

// Division of the image into cells, for decisions about its parts.

namespace cartvo::vo {

constexpr int kCellColumns = 16, kCellRows = 10;
constexpr int kCells = kCellColumns * kCellRows;

/// Index of the cell that contains the pixel or is nearest to it, row by row from the upper left.
inline int cellOf(const StereoCamera& camera, const Eigen::Vector2d& pixel) {
  const auto part = [](double position, int size, int count) {
    return std::clamp(static_cast<int>(position / size * count), 0, count - 1);
  };
  return part(pixel.y(), camera.height, kCellRows) * kCellColumns +
         part(pixel.x(), camera.width, kCellColumns);
}

}  // namespace cartvo::vo
