#pragma once

#include <vector>

#include "calib/model/rig.hpp"
#include "calib/rectification/rectification.hpp"

namespace cartvo::calib {

/// Raw rows of a grid of rectified pixels, as shares of the readout. The share of a raw row is
/// (row + 1/2) / rows - 1/2: -1/2 at the upper edge of the raw image, 1/2 at its lower edge.
struct RowShareGrid {
  int columns = 0;           ///< nodes in a row of the grid; 0: no grid
  std::vector<float> nodes;  ///< of the pixels (step * column, step * row), row by row
};

/// The grids of both cameras.
struct StereoRowShares {
  RowShareGrid left, right;
};

/// Shares of the readout for every `step` px of the rectified images, to the first node at or beyond the last
/// pixel, at least two nodes along each side. Exact at the nodes, also at those beyond the image. A source
/// outside the raw image counts as at most 2 `step` rows outside, so that interpolation between the nodes is
/// right up to the image's edge. No grids if the raw images are already rectified: raw and rectified rows are
/// the same.
StereoRowShares rowShares(const Rig& rig, const Rectification& rectification, int step);

}  // namespace cartvo::calib
