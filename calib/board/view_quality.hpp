#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board/board_view.hpp"

namespace cartvo::calib {

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
