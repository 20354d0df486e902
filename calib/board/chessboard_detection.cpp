// Detection of a chessboard, with the same numbering of its corners in both cameras.
#include "calib/board/chessboard_detection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/board/corner_refinement.hpp"
#include "calib/board/search_image.hpp"

namespace cartvo::calib {
namespace {

using Corners = std::vector<cv::Point2f>;

/// The corners of a board, row by row.
struct Grid {
  int columns = 0, rows = 0;
  Corners corners;

  const cv::Point2f& at(int column, int row) const {
    return corners[static_cast<std::size_t>(row) * columns + column];
  }
};

/// Side of the search image, px. Detection works best if squares are some tens of pixels wide.
constexpr double kCoarseSide = 900.0, kFineSide = 1600.0;

Corners toFullImage(const Corners& corners, const SearchImage& search) {
  Corners whole;
  for (const cv::Point2f& corner : corners) {
    const Eigen::Vector2f place = search.toFullImage(corner).cast<float>();
    whole.emplace_back(place.x(), place.y());
  }
  return whole;
}

/// Runs OpenCV's two detectors in turn: the first is fast, the second finds curved or blurred boards.
Corners findCorners(const cv::Mat& grey, const Chessboard& board) {
  const cv::Size size(board.columns, board.rows);
  Corners corners;
  for (const double side : {kCoarseSide, kFineSide}) {
    const SearchImage search(grey, side);
    for (const int flags :
         {cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK,
          cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_FAST_CHECK}) {
      if (cv::findChessboardCorners(search.image, size, corners, flags)) return toFullImage(corners, search);
    }
    if (search.scale <= 1.0) break;
  }
  const SearchImage search(grey, kCoarseSide);
  if (cv::findChessboardCornersSB(search.image, size, corners, 0)) return toFullImage(corners, search);
  return {};
}

/// The grid with each row in reverse order.
Grid mirrored(Grid grid) {
  for (int row = 0; row < grid.rows; ++row) {
    const auto begin = grid.corners.begin() + row * grid.columns;
    std::reverse(begin, begin + grid.columns);
  }
  return grid;
}

Grid turnedUpsideDown(Grid grid) {
  std::reverse(grid.corners.begin(), grid.corners.end());
  return grid;
}

/// The grid turned by 90 degrees clockwise: the first column, from bottom to top, becomes the first row.
Grid turnedByAQuarter(const Grid& grid) {
  Grid turned{grid.rows, grid.columns, {}};
  for (int row = 0; row < turned.rows; ++row) {
    for (int column = 0; column < turned.columns; ++column)
      turned.corners.push_back(grid.at(row, grid.rows - 1 - column));
  }
  return turned;
}

/// Whether the directions of rows and columns have the same handedness as x and y.
bool isSeenFromTheFront(const Grid& grid) {
  const cv::Point2f along = grid.at(grid.columns - 1, 0) - grid.at(0, 0);
  const cv::Point2f down = grid.at(0, grid.rows - 1) - grid.at(0, 0);
  return along.cross(down) > 0.0F;
}

float slopeToTheRight(const Grid& grid) {
  const cv::Point2f along = grid.at(grid.columns - 1, 0) - grid.at(0, 0);
  return along.x / std::max(std::hypot(along.x, along.y), 1e-6F);
}

/// The mean grey value around the centre of the square whose top left corner has these indices.
double greyOfSquare(const cv::Mat& grey, const Grid& grid, int column, int row) {
  const cv::Point2f centre = 0.25F * (grid.at(column, row) + grid.at(column + 1, row) +
                                      grid.at(column, row + 1) + grid.at(column + 1, row + 1));
  cv::Mat patch;
  cv::getRectSubPix(grey, {3, 3}, centre, patch);
  return cv::mean(patch)[0];
}

/// The sum of the grey values of the squares that are white on an upright board, minus that of the others.
double whiteOverBlack(const cv::Mat& grey, const Grid& grid) {
  double difference = 0.0;
  for (int row = 0; row + 1 < grid.rows; ++row) {
    for (int column = 0; column + 1 < grid.columns; ++column)
      difference += ((row + column) % 2 == 0 ? -1.0 : 1.0) * greyOfSquare(grey, grid, column, row);
  }
  return difference;
}

/// The grid in the numbering of detectChessboard.
Grid orientGrid(const cv::Mat& grey, Grid grid) {
  if (!isSeenFromTheFront(grid)) grid = mirrored(std::move(grid));
  if ((grid.columns + grid.rows) % 2 != 0) {
    return whiteOverBlack(grey, grid) > 0.0 ? grid : turnedUpsideDown(std::move(grid));
  }
  Grid best = grid;
  const int quarters = grid.columns == grid.rows ? 4 : 2;
  for (int quarter = 1; quarter < quarters; ++quarter) {
    grid = grid.columns == grid.rows ? turnedByAQuarter(grid) : turnedUpsideDown(std::move(grid));
    if (slopeToTheRight(grid) > slopeToTheRight(best)) best = grid;
  }
  return best;
}

}  // namespace

std::vector<SeenCorner> detectChessboard(const cv::Mat& grey, const Chessboard& board) {
  Grid grid{board.columns, board.rows, findCorners(grey, board)};
  if (grid.corners.empty()) return {};
  grid = orientGrid(grey, std::move(grid));
  std::vector<SeenCorner> seen;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const cv::Point2f& corner = grid.at(column, row);
      const cv::Point2f& beside = grid.at(column + 1 < grid.columns ? column + 1 : column - 1, row);
      const cv::Point2f& below = grid.at(column, row + 1 < grid.rows ? row + 1 : row - 1);
      const double room = 0.5 * std::min(cv::norm(beside - corner), cv::norm(below - corner));
      const std::optional<Eigen::Vector2d> refined = refineCorner(grey, {corner.x, corner.y}, room);
      if (!refined) return {};  // not a crossing of four squares, so not a board
      seen.push_back({row * grid.columns + column, *refined});
    }
  }
  return seen;
}

std::string describeChessboard(const cv::Mat& grey) {
  cv::Mat meta;
  Corners corners;
  constexpr int kMinCorners = 3;  // per side
  const bool found =
      cv::findChessboardCornersSB(SearchImage(grey, kCoarseSide).image, {kMinCorners, kMinCorners}, corners,
                                  cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER, meta);
  if (!found || meta.empty()) return {};
  return "a chessboard of " + std::to_string(meta.cols) + "x" + std::to_string(meta.rows) + " inner corners";
}

}  // namespace cartvo::calib
