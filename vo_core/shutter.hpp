#pragma once

#include <Eigen/Core>
#include <vector>

#include "vo_core/rig_calibration_error.hpp"

namespace cartvo::vo {

/// Instants at which a camera exposes the pixels of its rectified image, as shares of its readout. The share
/// of a raw pixel is (row + 1/2) / rows - 1/2 in the raw image: -1/2 at its upper edge, 0 in the middle, 1/2
/// at its lower edge. Rectification and lens distortion move a pixel by many rows, so the shares are a grid
/// over the rectified image.
class RowShares {
 public:
  static constexpr int kStep = 16;  ///< px from one node of the grid to the next

  /// Share of the rectified pixel itself: raw and rectified rows are the same.
  RowShares() = default;

  /// Shares of the pixels (kStep * column, kStep * row), row by row, with `columns` nodes in a row. The grid
  /// reaches the last pixel of the image or beyond. Throws std::invalid_argument if there are less than two
  /// columns or rows, or if the last row is incomplete.
  RowShares(int columns, std::vector<float> nodes);

  /// Share of a rectified pixel (px) of an image with `height` rows: bilinear between the nodes; that of the
  /// border for a pixel outside.
  double at(const Eigen::Vector2d& pixel, int height) const;

 private:
  int columns_ = 0;  ///< 0: no grid
  int rows_ = 0;
  std::vector<float> nodes_;
};

/// A camera's shutter. A rolling shutter exposes the rows of the raw image one after another; the instant of
/// an image is the mid-exposure of its middle row.
struct Shutter {
  /// s, mid-exposure of the lower edge of the raw image minus that of the upper edge; negative if the rows
  /// are exposed from bottom to top, 0: a global shutter.
  double readout = 0.0;
  double readout_stddev = 0.0;  ///< s; 0: known exactly
  RowShares rows;

  /// Whether pixels are exposed at different instants, or may be.
  bool isRolling() const { return readout != 0.0 || readout_stddev > 0.0; }
};

/// The shutters of both cameras; global by default.
struct StereoShutters {
  Shutter left, right;

  bool areRolling() const { return left.isRolling() || right.isRolling(); }
};

/// Throws std::invalid_argument that names the first value out of range.
void validate(const StereoShutters& shutters);

/// Readouts (s) as estimated while driving, with their standard deviations.
struct ReadoutEstimates {
  EstimateWithStddev left, right;
};

}  // namespace cartvo::vo
