// Layout of the black rectangles of a printed calibration board.
#include "calib/board/board_pattern.hpp"

#include <algorithm>

#include "calib/board/marker_dictionary.hpp"

namespace cartvo::calib {
namespace {

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

std::vector<cv::Rect2d> boardBlackRectangles(const BoardSpec& board) {
  return std::visit([](const auto& kind) { return rectanglesOf(kind); }, board);
}

}  // namespace cartvo::calib
