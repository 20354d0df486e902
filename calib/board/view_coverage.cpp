// Image and tilt coverage of board views, and advice on the next view.
#include "calib/board/view_coverage.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::calib {
namespace {

constexpr double kMinCoverage = 0.7;  // share of the cells
constexpr double kMinTilt = 0.17;     // rad: ten degrees

/// The ninth of the image with the lowest coverage, such as "upper left".
std::string emptiestPart(const ImageCoverage& coverage) {
  constexpr std::array kRows{"upper ", "middle ", "lower "};
  constexpr std::array kColumns{"left", "centre", "right"};
  double least = 2.0;
  std::string part;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      int seen = 0, cells = 0;
      for (int y = row * ImageCoverage::kRows / 3; y < (row + 1) * ImageCoverage::kRows / 3; ++y) {
        for (int x = column * ImageCoverage::kColumns / 3; x < (column + 1) * ImageCoverage::kColumns / 3;
             ++x) {
          ++cells;
          seen += coverage.corners[static_cast<std::size_t>(y) * ImageCoverage::kColumns + x] > 0 ? 1 : 0;
        }
      }
      const double share = static_cast<double>(seen) / cells;
      if (share >= least) continue;
      least = share;
      part = std::string(kRows[static_cast<std::size_t>(row)]) + kColumns[static_cast<std::size_t>(column)];
    }
  }
  return part;
}

}  // namespace

double ImageCoverage::share() const {
  const auto seen = std::count_if(corners.begin(), corners.end(), [](int count) { return count > 0; });
  return static_cast<double>(seen) / static_cast<double>(corners.size());
}

bool ImageCoverage::covers(const Eigen::Vector2d& pixel, cv::Size size) const {
  const double column = std::floor(pixel.x() * kColumns / size.width),
               row = std::floor(pixel.y() * kRows / size.height);
  if (!(column >= 0.0 && row >= 0.0 && column < kColumns && row < kRows)) return false;
  return corners[static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(column)] > 0;
}

ImageCoverage coverageOf(const std::vector<BoardView>& views, std::vector<SeenCorner> BoardView::*side,
                         cv::Size size) {
  ImageCoverage coverage;
  for (const BoardView& view : views) {
    for (const SeenCorner& corner : view.*side) {
      const int column = std::clamp(static_cast<int>(corner.pixel.x() * ImageCoverage::kColumns / size.width),
                                    0, ImageCoverage::kColumns - 1);
      const int row = std::clamp(static_cast<int>(corner.pixel.y() * ImageCoverage::kRows / size.height), 0,
                                 ImageCoverage::kRows - 1);
      ++coverage.corners[static_cast<std::size_t>(row) * ImageCoverage::kColumns + column];
    }
  }
  return coverage;
}

TiltCoverage tiltsOf(const std::vector<Eigen::Isometry3d>& T_camera_board) {
  TiltCoverage tilts;
  std::vector<Eigen::Vector3d> normals;
  for (const Eigen::Isometry3d& pose : T_camera_board) {
    const Eigen::Vector3d normal = pose.linear().col(2);
    for (const Eigen::Vector3d& other : normals)
      tilts.spread = std::max(tilts.spread, std::acos(std::clamp(normal.dot(other), -1.0, 1.0)));
    normals.push_back(normal);
    const double sideways = std::atan2(normal.x(), std::abs(normal.z()));
    const double upwards = std::atan2(normal.y(), std::abs(normal.z()));
    tilts.to_left |= sideways < -kMinTilt;
    tilts.to_right |= sideways > kMinTilt;
    tilts.up |= upwards < -kMinTilt;
    tilts.down |= upwards > kMinTilt;
  }
  return tilts;
}

std::string nextViewAdvice(const ImageCoverage& left, const ImageCoverage& right, const TiltCoverage& tilts) {
  const bool left_is_poorer = left.share() <= right.share();
  if (std::min(left.share(), right.share()) < kMinCoverage) {
    return std::string("show the board in the ") + emptiestPart(left_is_poorer ? left : right) + " of the " +
           (left_is_poorer ? "left" : "right") + " image";
  }
  if (!tilts.to_left || !tilts.to_right)
    return "turn the board: its left or right edge nearer to the cameras";
  if (!tilts.up || !tilts.down) return "tip the board: its upper or lower edge nearer to the cameras";
  return {};
}

}  // namespace cartvo::calib
