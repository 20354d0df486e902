// Board detection by the detector of the board's kind; that of chessboards.
#include "calib/board/board_detection.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/board/board_spec.hpp"
#include "calib/board/board_view.hpp"
#include "calib/board/corner_refinement.hpp"
#include "calib/board/marker_detection.hpp"
#include "common/image_size.hpp"

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

/// The direction of the first row, of length 1.
cv::Point2f rowDirection(const Grid& grid) {
  const cv::Point2f along = grid.at(grid.columns - 1, 0) - grid.at(0, 0);
  return along / std::max(std::hypot(along.x, along.y), 1e-6F);
}

/// Whether the board looks the same after a half turn: the colours of its squares do not tell which side is
/// up.
bool isAmbiguous(int columns, int rows) {
  return (columns + rows) % 2 == 0;
}

/// The grid in the order whose first row points most in a direction, among those that look the same.
Grid turnedTowards(Grid grid, const cv::Point2f& direction) {
  Grid best = grid;
  const int turns = grid.columns == grid.rows ? 4 : 2;
  for (int turn = 1; turn < turns; ++turn) {
    grid = grid.columns == grid.rows ? turnedByAQuarter(grid) : turnedUpsideDown(std::move(grid));
    if (rowDirection(grid).dot(direction) > rowDirection(best).dot(direction)) best = grid;
  }
  return best;
}

Grid gridOf(const Chessboard& board, const std::vector<SeenCorner>& seen) {
  Grid grid{board.columns, board.rows, {}};
  for (const SeenCorner& corner : seen)
    grid.corners.emplace_back(static_cast<float>(corner.pixel.x()), static_cast<float>(corner.pixel.y()));
  return grid;
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
  if (!isAmbiguous(grid.columns, grid.rows))
    return whiteOverBlack(grey, grid) > 0.0 ? grid : turnedUpsideDown(std::move(grid));
  // Boards are held level or upright: at neither angle do two orders fit equally well.
  const cv::Point2f right_and_down(0.92F, 0.38F);
  return turnedTowards(std::move(grid), right_and_down);
}

/// Detects the inner corners of a chessboard that is completely visible; empty otherwise. The numbering is
/// the same in both cameras: the top left square of a board with one odd and one even side is its black
/// corner. Other boards look the same upside down; for them the direction of the rows is the one that points
/// most to the right and a little down in the image, and matchNumbering makes the numbering the same.
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

/// Renumbers the corners of the right image so that rows run as in the left one, for a board that looks the
/// same after a half turn, or a quarter turn if it is square. The cameras may be turned against each other
/// about their axes by less than 90 (45) degrees.
void matchNumbering(const Chessboard& board, const std::vector<SeenCorner>& left,
                    std::vector<SeenCorner>& right) {
  const std::size_t count = static_cast<std::size_t>(board.columns) * static_cast<std::size_t>(board.rows);
  if (!isAmbiguous(board.columns, board.rows) || left.size() != count || right.size() != count) return;
  // The corners' places in the right image, in the order of each numbering.
  Grid numbers{board.columns, board.rows, {}};
  for (std::size_t i = 0; i < count; ++i)
    numbers.corners.emplace_back(static_cast<float>(i), 0.0F);
  const cv::Point2f direction = rowDirection(gridOf(board, left));
  Grid grid = gridOf(board, right);
  const Grid wanted = turnedTowards(grid, direction);
  const bool is_square = board.columns == board.rows;
  while (grid.corners != wanted.corners) {
    grid = is_square ? turnedByAQuarter(grid) : turnedUpsideDown(std::move(grid));
    numbers = is_square ? turnedByAQuarter(numbers) : turnedUpsideDown(std::move(numbers));
  }
  const std::vector<SeenCorner> before = right;
  for (std::size_t i = 0; i < count; ++i)
    right[i].pixel = before[static_cast<std::size_t>(numbers.corners[i].x)].pixel;
}

/// Number of inner corners along and across the chessboard in an image, whatever its size; nothing if there
/// is none.
std::optional<cv::Size> chessboardSize(const cv::Mat& grey) {
  cv::Mat meta;
  Corners corners;
  constexpr int kMinCorners = 3;  // per side
  const bool found =
      cv::findChessboardCornersSB(SearchImage(grey, kCoarseSide).image, {kMinCorners, kMinCorners}, corners,
                                  cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER, meta);
  if (!found || meta.empty()) return std::nullopt;
  return meta.size();
}

std::string chessboardText(cv::Size inner_corners) {
  return "a chessboard of " + sizeText(inner_corners) + " inner corners";
}

}  // namespace

std::vector<SeenCorner> detectBoard(const cv::Mat& grey, const BoardSpec& board) {
  if (const auto* const chessboard = std::get_if<Chessboard>(&board))
    return detectChessboard(grey, *chessboard);
  if (const auto* const charuco = std::get_if<Charuco>(&board)) return detectCharuco(grey, *charuco);
  return detectAprilGrid(grey, std::get<AprilGrid>(board));
}

void matchNumbering(const BoardSpec& board, BoardView& view) {
  if (const auto* const chessboard = std::get_if<Chessboard>(&board))
    matchNumbering(*chessboard, view.left, view.right);
}

std::string describeLargerBoard(const cv::Mat& grey, const BoardSpec& board) {
  const auto* const chessboard = std::get_if<Chessboard>(&board);
  if (chessboard == nullptr) return {};
  std::optional<cv::Size> seen = chessboardSize(grey);
  if (!seen || seen->area() <= chessboard->columns * chessboard->rows) return {};
  // The detector may name the columns rows.
  if ((seen->width > seen->height) != (chessboard->columns > chessboard->rows))
    std::swap(seen->width, seen->height);
  return chessboardText(*seen);
}

std::string describeOtherBoard(const cv::Mat& grey, const BoardSpec& board) {
  if (std::holds_alternative<Chessboard>(board)) {
    const std::optional<cv::Size> seen = chessboardSize(grey);
    return seen ? chessboardText(*seen) : std::string();
  }
  return describeUnknownMarker(grey, board);
}

}  // namespace cartvo::calib
