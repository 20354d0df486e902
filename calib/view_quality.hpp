#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "calib/board_view.hpp"

namespace cartvo {

/// How well an image shows a board, measured about its corners.
struct ViewQuality {
  double edge_width = 0.0;  ///< px over which the grey value changes from black to white: more where blurred
  double contrast = 0.0;    ///< white minus black, grey levels
  double white = 0.0;       ///< grey level
  double black = 0.0;       ///< grey level
  /// How many times as long as wide the board's squares look, over all corners: 1 seen face on, 4 tilted by
  /// 75 degrees; infinite if the corners lie on a line.
  double foreshortening = 1.0;
};

/// Medians over the corners; needs at least one.
ViewQuality viewQuality(const cv::Mat& grey, const std::vector<SeenCorner>& seen,
                        const std::vector<Eigen::Vector2d>& board_corners);

/// Why the image is too blurred, too dark, too bright or too dull to measure corners in, or the board tilted
/// too far, as a clause for people ("it is blurred: ..."); empty if it will do. `usual_edge_width`: of the
/// other views, px.
std::string qualityProblem(const ViewQuality& quality, double usual_edge_width);

}  // namespace cartvo
