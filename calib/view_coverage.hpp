#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/board_view.hpp"

namespace cartvo {

/// Where an image has shown corners: cells of equal size, row by row.
struct ImageCoverage {
  static constexpr int kColumns = 8, kRows = 5;
  std::array<int, kColumns * kRows> corners{};

  /// The share of the cells in which there was a corner.
  double share() const;

  /// Whether there was a corner in the cell of this pixel of images of `size`; false outside the image.
  bool covers(const Eigen::Vector2d& pixel, cv::Size size) const;
};

/// Where corners lay in one camera's image of `size`.
ImageCoverage coverageOf(const std::vector<BoardView>& views, std::vector<SeenCorner> BoardView::*side,
                         cv::Size size);

/// How boards were turned against the camera.
struct TiltCoverage {
  double spread = 0.0;  ///< the largest angle between two boards' planes, rad
  bool to_left = false, to_right = false, up = false, down = false;  ///< tilted by ten degrees and more
};

/// `T_camera_board`: see boardPose.
TiltCoverage tiltsOf(const std::vector<Eigen::Isometry3d>& T_camera_board);

/// What to show next, as a sentence for a person before the cameras; empty if there is enough: corners in
/// seven of ten cells, and the board tilted all four ways.
std::string whatToShowNext(const ImageCoverage& left, const ImageCoverage& right, const TiltCoverage& tilts);

}  // namespace cartvo
