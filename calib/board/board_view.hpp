#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace cartvo::calib {

/// A corner of a board, detected in an image.
struct SeenCorner {
  int id = 0;             ///< index in boardCorners
  Eigen::Vector2d pixel;  ///< position, px; pixel centres at integers

  bool operator==(const SeenCorner&) const = default;
};

/// The corners of a board in both images of a pair, taken at one instant or while the board is held still.
struct BoardView {
  std::string name;               ///< for messages: the file or the instant
  std::vector<SeenCorner> left;   ///< sorted by id
  std::vector<SeenCorner> right;  ///< sorted by id
};

}  // namespace cartvo::calib
