#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "calib/board/board_view.hpp"

namespace cartvo::calib {

/// Coverage of an image by corners: the number of corners in cells of equal size, row by row.
struct ImageCoverage {
  static constexpr int kColumns = 8, kRows = 5;
  std::array<int, kColumns * kRows> corners{};

  /// Share of the cells with at least one corner.
  double share() const;

  /// Whether the cell of this pixel, in images of `size`, has a corner. False outside the image.
  bool covers(const Eigen::Vector2d& pixel, cv::Size size) const;
};

/// Counts the corners in one camera's images of `size`.
ImageCoverage coverageOf(const std::vector<BoardView>& views, std::vector<SeenCorner> BoardView::*side,
                         cv::Size size);

/// Tilts of the boards relative to the camera.
struct TiltCoverage {
  double spread = 0.0;  ///< largest angle between the planes of two boards, rad
  /// Whether a board was tilted by at least ten degrees in each direction.
  bool to_left = false, to_right = false, up = false, down = false;
};

/// Computes the tilts from the boards' poses, see boardPose.
TiltCoverage tiltsOf(const std::vector<Eigen::Isometry3d>& T_camera_board);

/// Advice on where to hold the board next. Empty if the coverage is sufficient: corners in 70 % of the cells
/// of both images, and the board tilted in all four directions.
std::string nextViewAdvice(const ImageCoverage& left, const ImageCoverage& right, const TiltCoverage& tilts);

/// Image quality of a board, measured around its corners.
struct ViewQuality {
  double edge_width = 0.0;  ///< width of the transition from black to white, px; grows with blur
  double contrast = 0.0;    ///< white minus black, grey levels
  double white = 0.0;       ///< grey level
  double black = 0.0;       ///< grey level
  /// Ratio of length to width of the board's squares in the image, over all corners: 1 if seen face on, 4 if
  /// tilted by 75 degrees, infinite if the corners are collinear.
  double foreshortening = 1.0;
};

/// Measures the quality: medians over the corners. Requires at least one corner.
ViewQuality viewQuality(const cv::Mat& grey, const std::vector<SeenCorner>& seen,
                        const std::vector<Eigen::Vector2d>& board_corners);

/// The reason why corners cannot be measured in the image, such as "it is blurred: ...": too blurred, too
/// dark, too bright, too little contrast, or a board tilted too far. Empty if the quality is sufficient.
/// `usual_edge_width`: that of the other views, px.
std::string qualityProblem(const ViewQuality& quality, double usual_edge_width);

}  // namespace cartvo::calib
