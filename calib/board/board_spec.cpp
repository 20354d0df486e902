// Board specifications: parsing and writing the text, positions of corners and markers, the drawn pattern.
#include "calib/board/board_spec.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include "common/exact_text.hpp"

namespace cartvo::calib {
namespace {

constexpr const char* kForms =
    "chessboard:COLUMNSxROWS:SQUARE (inner corners; metres), charuco:COLUMNSxROWS:SQUARE:MARKER (squares; "
    "metres) or aprilgrid:COLUMNSxROWS:TAG:SPACING (tags; metres, and the gap in sides of a tag)";

/// The parts of a board specification between its colons.
class SpecParts {
 public:
  explicit SpecParts(const std::string& text) : text_(text) {
    std::size_t begin = 0;
    for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
      end = text.find(':', begin);
      parts_.push_back(text.substr(begin, end - begin));
    }
  }

  const std::string& kind() const { return parts_.front(); }
  std::size_t count() const { return parts_.size(); }

  void requireCount(std::size_t min, std::size_t max) const {
    if (count() < min || count() > max) fail("it has " + std::to_string(count()) + " parts");
  }

  /// Parses "COLUMNSxROWS", each at least `min`.
  std::array<int, 2> grid(std::size_t index, int min) const {
    const std::string& part = parts_[index];
    const std::size_t cross = part.find('x');
    std::array<int, 2> sides{};
    if (cross == std::string::npos || !read(part.substr(0, cross), sides[0]) ||
        !read(part.substr(cross + 1), sides[1])) {
      fail("'" + part + "' is not COLUMNSxROWS, such as 9x6");
    }
    for (const int side : sides) {
      if (side < min || side > kMaxPerSide) {
        fail("'" + part + "' must have " + std::to_string(min) + " to " + std::to_string(kMaxPerSide) +
             " along each side");
      }
    }
    return sides;
  }

  double length(std::size_t index, const char* what) const {
    constexpr double kMinLength = 0.001, kMaxLength = 2.0;  // m
    const double value = number(index, what);
    if (!(value >= kMinLength && value <= kMaxLength)) {
      fail(std::string(what) + " of " + parts_[index] +
           " m must lie in 0.001 to 2 m; was it given in millimetres?");
    }
    return value;
  }

  double number(std::size_t index, const char* what) const {
    double value = 0.0;
    if (!read(parts_[index], value)) fail(std::string(what) + " '" + parts_[index] + "' is not a number");
    return value;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw std::invalid_argument("board '" + text_ + "': " + problem + "; expected " + kForms);
  }

 private:
  static constexpr int kMaxPerSide = 100;

  template <typename Number>
  static bool read(const std::string& part, Number& value) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    return error == std::errc{} && end == part.data() + part.size() && std::isfinite(double(value));
  }

  std::string text_;
  std::vector<std::string> parts_;
};

BoardSpec readChessboard(const SpecParts& parts) {
  constexpr int kMinCorners = 3;  // the minimum of cv::findChessboardCorners
  parts.requireCount(3, 3);
  const auto [columns, rows] = parts.grid(1, kMinCorners);
  return Chessboard{columns, rows, parts.length(2, "a square's side")};
}

BoardSpec readCharuco(const SpecParts& parts) {
  constexpr int kMinSquares = 3, kMinBits = 4, kMaxBits = 7, kMaxMarkers = 1000;
  parts.requireCount(4, 5);
  const auto [columns, rows] = parts.grid(1, kMinSquares);
  Charuco board{columns, rows, parts.length(2, "a square's side"), parts.length(3, "a marker's side"), {}};
  if (!(board.marker < board.square)) parts.fail("the markers must be smaller than the squares");
  board.marker_bits = kMinBits;
  if (parts.count() == 5) {
    const auto [across, down] = parts.grid(4, kMinBits);
    if (across != down || across > kMaxBits) parts.fail("markers have 4x4, 5x5, 6x6 or 7x7 bits");
    board.marker_bits = across;
  }
  if (columns * rows / 2 > kMaxMarkers) parts.fail("the board needs more than the 1000 markers that exist");
  return board;
}

BoardSpec readAprilGrid(const SpecParts& parts) {
  constexpr int kTagsOf36h11 = 587;
  constexpr double kMinSpacing = 0.05, kMaxSpacing = 2.0;
  parts.requireCount(4, 4);
  const auto [columns, rows] = parts.grid(1, 1);
  const AprilGrid board{columns, rows, parts.length(2, "a tag's side"), parts.number(3, "the spacing")};
  if (!(board.spacing >= kMinSpacing && board.spacing <= kMaxSpacing)) {
    parts.fail("the spacing must lie in 0.05 to 2: it is the gap divided by the tag's side");
  }
  if (columns * rows > kTagsOf36h11) parts.fail("the board needs more than the 587 tags of 36h11");
  return board;
}

/// Inner corners, row by row, of a board with `columns` by `rows` squares.
std::vector<Eigen::Vector2d> innerCorners(int columns, int rows, double square) {
  std::vector<Eigen::Vector2d> corners;
  for (int row = 1; row < rows; ++row) {
    for (int column = 1; column < columns; ++column)
      corners.emplace_back(column * square, row * square);
  }
  return corners;
}

/// The corners of a square, clockwise from the top left, seen from the front.
std::array<Eigen::Vector2d, 4> squareAt(double left, double top, double side) {
  return {Eigen::Vector2d(left, top), Eigen::Vector2d(left + side, top),
          Eigen::Vector2d(left + side, top + side), Eigen::Vector2d(left, top + side)};
}

std::vector<BoardMarker> markersOf(const Chessboard& /*board*/) {
  return {};
}

std::vector<BoardMarker> markersOf(const Charuco& board) {
  const double margin = (board.square - board.marker) / 2.0;
  std::vector<BoardMarker> markers;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      if ((row + column) % 2 == 0) continue;  // black
      markers.push_back(
          {static_cast<int>(markers.size()),
           squareAt(column * board.square + margin, row * board.square + margin, board.marker)});
    }
  }
  return markers;
}

std::vector<BoardMarker> markersOf(const AprilGrid& board) {
  const double gap = board.spacing * board.tag;
  std::vector<BoardMarker> markers;
  for (int row = board.rows - 1; row >= 0; --row) {
    for (int column = 0; column < board.columns; ++column) {
      const auto [top_left, top_right, bottom_right, bottom_left] =
          squareAt(gap + column * (board.tag + gap), gap + row * (board.tag + gap), board.tag);
      markers.push_back({static_cast<int>(markers.size()), {bottom_right, bottom_left, top_left, top_right}});
    }
  }
  return markers;
}

Eigen::Vector2d extentOf(const Chessboard& board) {
  return board.square * Eigen::Vector2d(board.columns + 1, board.rows + 1);
}

Eigen::Vector2d extentOf(const Charuco& board) {
  return board.square * Eigen::Vector2d(board.columns, board.rows);
}

Eigen::Vector2d extentOf(const AprilGrid& board) {
  const double gap = board.spacing * board.tag;
  return (board.tag + gap) * Eigen::Vector2d(board.columns, board.rows) + Eigen::Vector2d(gap, gap);
}

std::vector<Eigen::Vector2d> cornersOf(const Chessboard& board) {
  return innerCorners(board.columns + 1, board.rows + 1, board.square);
}

std::vector<Eigen::Vector2d> cornersOf(const Charuco& board) {
  return innerCorners(board.columns, board.rows, board.square);
}

std::vector<Eigen::Vector2d> cornersOf(const AprilGrid& board) {
  std::vector<Eigen::Vector2d> corners;
  for (const BoardMarker& marker : markersOf(board))
    corners.insert(corners.end(), marker.corners.begin(), marker.corners.end());
  return corners;
}

std::string gridText(int columns, int rows) {
  return std::to_string(columns) + "x" + std::to_string(rows);
}

std::string textOf(const Chessboard& board) {
  return "chessboard:" + gridText(board.columns, board.rows) + ":" + exactText(board.square);
}

std::string textOf(const Charuco& board) {
  const std::string text = "charuco:" + gridText(board.columns, board.rows) + ":" + exactText(board.square) +
                           ":" + exactText(board.marker);
  const bool is_usual = board.marker_bits == Charuco{}.marker_bits;
  return is_usual ? text : text + ":" + gridText(board.marker_bits, board.marker_bits);
}

std::string textOf(const AprilGrid& board) {
  return "aprilgrid:" + gridText(board.columns, board.rows) + ":" + exactText(board.tag) + ":" +
         exactText(board.spacing);
}

/// OpenCV's dictionaries of 50, 100, 250 and 1000 markers of n x n bits start with the same codes, and their
/// enumerators are consecutive, starting with 4x4.
constexpr std::array kSizes{50, 100, 250, 1000};
constexpr int kMinBits = 4;

/// Index in kSizes of the smallest dictionary that has enough markers.
std::size_t sizeIndex(const Charuco& board) {
  const int markers = board.columns * board.rows / 2;
  std::size_t index = 0;
  while (index + 1 < kSizes.size() && kSizes[index] < markers)
    ++index;
  return index;
}

MarkerDictionary charucoDictionary(const Charuco& board) {
  const int name = cv::aruco::DICT_4X4_50 + static_cast<int>(kSizes.size()) * (board.marker_bits - kMinBits) +
                   static_cast<int>(sizeIndex(board));
  return {cv::aruco::getPredefinedDictionary(name), 1};
}

using Rectangles = std::vector<cv::Rect2d>;

/// The black squares of a chessboard whose top left square is black.
Rectangles blackSquares(int columns, int rows, double side) {
  Rectangles squares;
  for (int row = 0; row < rows; ++row) {
    for (int column = row % 2; column < columns; column += 2)
      squares.emplace_back(column * side, row * side, side, side);
  }
  return squares;
}

/// A marker's bits with its border, oriented as in the dictionary: CV_8UC1, 0 is black.
cv::Mat markerBits(const MarkerDictionary& markers, int id) {
  const int bits = markers.dictionary->markerSize;
  const cv::Mat inner =
      cv::aruco::Dictionary::getBitsFromByteList(markers.dictionary->bytesList.rowRange(id, id + 1), bits);
  const int side = bits + 2 * markers.border_bits;
  cv::Mat all = cv::Mat::zeros(side, side, CV_8UC1);
  inner.copyTo(all(cv::Rect(markers.border_bits, markers.border_bits, bits, bits)));
  return all;
}

/// The cells [column, end_column) of a row of a marker, as a rectangle on the board.
cv::Rect2d cellsOf(const BoardMarker& marker, double bits, int row, int column, int end_column) {
  const auto at = [&](double x, double y) {
    const Eigen::Vector2d point = marker.corners[0] + x / bits * (marker.corners[1] - marker.corners[0]) +
                                  y / bits * (marker.corners[3] - marker.corners[0]);
    return cv::Point2d(point.x(), point.y());
  };
  return {at(column, row), at(end_column, row + 1)};
}

/// Adds a marker's black cells, row by row; adjacent ones become one rectangle.
void addMarker(const BoardMarker& marker, const cv::Mat& bits, Rectangles& rectangles) {
  for (int row = 0; row < bits.rows; ++row) {
    for (int column = 0; column < bits.cols; ++column) {
      if (bits.at<std::uint8_t>(row, column) != 0) continue;
      const int begin = column;
      while (column < bits.cols && bits.at<std::uint8_t>(row, column) == 0)
        ++column;
      rectangles.push_back(cellsOf(marker, bits.cols, row, begin, column));
    }
  }
}

void addMarkers(const BoardSpec& board, Rectangles& rectangles) {
  const MarkerDictionary markers = markerDictionary(board);
  for (const BoardMarker& marker : boardMarkers(board))
    addMarker(marker, markerBits(markers, marker.id), rectangles);
}

Rectangles rectanglesOf(const Chessboard& board) {
  return blackSquares(board.columns + 1, board.rows + 1, board.square);
}

Rectangles rectanglesOf(const Charuco& board) {
  Rectangles rectangles = blackSquares(board.columns, board.rows, board.square);
  addMarkers(board, rectangles);
  return rectangles;
}

Rectangles rectanglesOf(const AprilGrid& board) {
  const double gap = board.spacing * board.tag, step = board.tag + gap;
  Rectangles rectangles;
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column)
      rectangles.emplace_back(column * step, row * step, gap, gap);
  }
  addMarkers(board, rectangles);
  return rectangles;
}

}  // namespace

BoardSpec parseBoardSpec(const std::string& text) {
  const SpecParts parts(text);
  if (parts.kind() == "chessboard") return readChessboard(parts);
  if (parts.kind() == "charuco") return readCharuco(parts);
  if (parts.kind() == "aprilgrid") return readAprilGrid(parts);
  parts.fail("unknown kind '" + parts.kind() + "'");
}

std::string boardSpecText(const BoardSpec& board) {
  return std::visit([](const auto& kind) { return textOf(kind); }, board);
}

Eigen::Vector2d boardExtent(const BoardSpec& board) {
  return std::visit([](const auto& kind) { return extentOf(kind); }, board);
}

std::vector<Eigen::Vector2d> boardCorners(const BoardSpec& board) {
  return std::visit([](const auto& kind) { return cornersOf(kind); }, board);
}

std::vector<BoardMarker> boardMarkers(const BoardSpec& board) {
  return std::visit([](const auto& kind) { return markersOf(kind); }, board);
}

std::string dictionaryName(const BoardSpec& board) {
  if (std::holds_alternative<AprilGrid>(board)) return "DICT_APRILTAG_36h11";
  const auto* const charuco = std::get_if<Charuco>(&board);
  if (charuco == nullptr) return {};
  const std::string bits = std::to_string(charuco->marker_bits);
  return "DICT_" + bits + "X" + bits + "_" + std::to_string(kSizes[sizeIndex(*charuco)]);
}

MarkerDictionary markerDictionary(const BoardSpec& board) {
  if (const auto* charuco = std::get_if<Charuco>(&board)) return charucoDictionary(*charuco);
  if (std::holds_alternative<AprilGrid>(board)) {
    return {cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), 2};
  }
  throw std::invalid_argument("a chessboard has no markers");
}

std::vector<cv::Rect2d> boardBlackRectangles(const BoardSpec& board) {
  return std::visit([](const auto& kind) { return rectanglesOf(kind); }, board);
}

}  // namespace cartvo::calib
