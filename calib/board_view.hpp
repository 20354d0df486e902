#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace cartvo {

/// A corner of a board as an image shows it.
struct SeenCorner {
  int id = 0;             ///< place in boardCorners
  Eigen::Vector2d pixel;  ///< px, pixel centres at integers

  bool operator==(const SeenCorner&) const = default;
};

/// A board held before both cameras at one instant, or held still.
struct BoardView {
  std::string name;               ///< for people: the file, or the instant
  std::vector<SeenCorner> left;   ///< by rising id
  std::vector<SeenCorner> right;  ///< by rising id
};

}  // namespace cartvo
