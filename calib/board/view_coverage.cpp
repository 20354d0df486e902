// Image and tilt coverage of board views, advice on the next view, and the quality of a view.
#include "calib/board/view_coverage.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/exact_text.hpp"
#include "common/statistics.hpp"

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

/// Ratio of the singular values of the affine map from board to image that fits the corners best.
double foreshorteningOf(const std::vector<SeenCorner>& seen,
                        const std::vector<Eigen::Vector2d>& board_corners) {
  Eigen::Vector2d board_mean = Eigen::Vector2d::Zero(), image_mean = Eigen::Vector2d::Zero();
  for (const SeenCorner& corner : seen) {
    board_mean += board_corners[static_cast<std::size_t>(corner.id)] / static_cast<double>(seen.size());
    image_mean += corner.pixel / static_cast<double>(seen.size());
  }
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero(), mapped = Eigen::Matrix2d::Zero();
  for (const SeenCorner& corner : seen) {
    const Eigen::Vector2d place = board_corners[static_cast<std::size_t>(corner.id)] - board_mean;
    spread += place * place.transpose();
    mapped += (corner.pixel - image_mean) * place.transpose();
  }
  constexpr double kCollinear = 1e-6;  // relative to the board's extent, squared
  if (spread.determinant() <= kCollinear * spread.trace() * spread.trace())
    return std::numeric_limits<double>::infinity();
  const Eigen::Vector2d lengths =
      Eigen::JacobiSVD<Eigen::Matrix2d>(mapped * spread.inverse()).singularValues();
  return lengths[0] / lengths[1];
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

ViewQuality viewQuality(const cv::Mat& grey, const std::vector<SeenCorner>& seen,
                        const std::vector<Eigen::Vector2d>& board_corners) {
  constexpr int kWindowRadius = 6;  // px
  std::vector<double> widths, whites, blacks;
  for (const SeenCorner& corner : seen) {
    const int x = static_cast<int>(std::lround(corner.pixel.x()));
    const int y = static_cast<int>(std::lround(corner.pixel.y()));
    int black = 255, white = 0;
    double steepest = 1.0;  // grey levels per pixel
    for (int v = std::max(y - kWindowRadius, 1); v <= std::min(y + kWindowRadius, grey.rows - 2); ++v) {
      for (int u = std::max(x - kWindowRadius, 1); u <= std::min(x + kWindowRadius, grey.cols - 2); ++u) {
        const int value = grey.at<std::uint8_t>(v, u);
        black = std::min(black, value);
        white = std::max(white, value);
        const double along = 0.5 * (grey.at<std::uint8_t>(v, u + 1) - grey.at<std::uint8_t>(v, u - 1));
        const double down = 0.5 * (grey.at<std::uint8_t>(v + 1, u) - grey.at<std::uint8_t>(v - 1, u));
        steepest = std::max(steepest, std::hypot(along, down));
      }
    }
    widths.push_back((white - black) / steepest);
    whites.push_back(white);
    blacks.push_back(black);
  }
  ViewQuality quality;
  quality.edge_width = medianOf(widths);
  quality.white = medianOf(whites);
  quality.black = medianOf(blacks);
  quality.contrast = quality.white - quality.black;
  quality.foreshortening = foreshorteningOf(seen, board_corners);
  return quality;
}

std::string qualityProblem(const ViewQuality& quality, double usual_edge_width) {
  constexpr double kMinContrast = 30.0, kMinWhite = 60.0, kMaxBlack = 180.0;  // grey levels
  constexpr double kMaxSharpWidth = 4.0;                                      // px
  constexpr double kMaxRelativeWidth = 1.8;                                   // of the usual edge width
  constexpr double kMaxForeshortening = 4.0;
  if (!std::isfinite(quality.foreshortening)) return "the corners that it shows lie on one line";
  if (quality.foreshortening > kMaxForeshortening) {
    return "the board is tilted too far: its squares look " + fixedText(quality.foreshortening, 1) +
           " times as long as wide";
  }
  if (quality.contrast < kMinContrast) {
    if (quality.white < kMinWhite)
      return "it is too dark: the board's white is at grey level " + fixedText(quality.white, 1);
    if (quality.black > kMaxBlack)
      return "it is overexposed: the board's black is at grey level " + fixedText(quality.black, 1);
    return "the board's black and white are only " + fixedText(quality.contrast, 1) + " grey levels apart";
  }
  if (quality.edge_width > std::max(kMaxSharpWidth, kMaxRelativeWidth * usual_edge_width)) {
    return "it is blurred: edges are " + fixedText(quality.edge_width, 1) + " px wide, in other views " +
           fixedText(usual_edge_width, 1) + " px";
  }
  return {};
}

}  // namespace cartvo::calib
