#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <variant>
#include <vector>

#include <opencv2/aruco.hpp>
#include <opencv2/core/types.hpp>

namespace cartvo::calib {

/// A chessboard. As in OpenCV, its size is the number of inner corners, where four squares meet.
struct Chessboard {
  int columns = 0, rows = 0;  ///< inner corners
  double square = 0.0;        ///< side of a square, m

  bool operator==(const Chessboard&) const = default;
};

/// A chessboard with an ArUco marker in each white square, like cv::aruco::CharucoBoard: the top left square
/// is black, and markers are numbered row by row from the top left.
struct Charuco {
  int columns = 0, rows = 0;  ///< squares
  double square = 0.0;        ///< side of a square, m
  double marker = 0.0;        ///< side of a marker with its black border, m
  int marker_bits = 4;        ///< bits along a marker's side without its border, 4 to 7

  bool operator==(const Charuco&) const = default;
};

/// Kalibr's AprilGrid: 36h11 tags with a border of two bits, numbered row by row from the bottom left, and a
/// small black square where four gaps meet, so that each corner of a tag is a crossing of two edges.
struct AprilGrid {
  int columns = 0, rows = 0;  ///< tags
  double tag = 0.0;           ///< side of a tag with its black border, m
  double spacing = 0.0;       ///< gap between tags, relative to `tag`

  bool operator==(const AprilGrid&) const = default;
};

using BoardSpec = std::variant<Chessboard, Charuco, AprilGrid>;

/// Parses chessboard:COLUMNSxROWS:SQUARE, charuco:COLUMNSxROWS:SQUARE:MARKER[:BITSxBITS] or
/// aprilgrid:COLUMNSxROWS:TAG:SPACING, lengths in metres. Throws std::invalid_argument naming the text, its
/// fault and what was expected.
BoardSpec parseBoardSpec(const std::string& text);

/// The text of a board, which `parseBoardSpec` reads back to the last bit.
std::string boardSpecText(const BoardSpec& board);

// Board axes, m: seen from the front, x points right, y down and z away from the viewer; the origin is the
// top left corner of the printed pattern. All points have z = 0, which is omitted.

/// Width and height of the printed pattern, between the outer edges of the outer (small black) squares, m.
Eigen::Vector2d boardExtent(const BoardSpec& board);

/// The corners to detect, indexed by id: for a chessboard and ChArUco the inner corners row by row from the
/// top left (as cv::findChessboardCorners and cv::aruco number them); for an AprilGrid corner k of tag i at 4
/// i + k, in the order of `BoardMarker::corners`.
std::vector<Eigen::Vector2d> boardCorners(const BoardSpec& board);

/// A marker on a board.
struct BoardMarker {
  int id = 0;
  /// Corners in the order of cv::aruco::detectMarkers: clockwise from the top left for a marker of a ChArUco
  /// board, clockwise from the bottom right for a tag of an AprilGrid, since Kalibr prints tags upside down
  /// relative to OpenCV.
  std::array<Eigen::Vector2d, 4> corners;
};

/// The markers of a board, indexed by id. Empty for a chessboard.
std::vector<BoardMarker> boardMarkers(const BoardSpec& board);

/// ArUco dictionary of a board's markers, to draw and to detect them.
struct MarkerDictionary {
  cv::Ptr<cv::aruco::Dictionary> dictionary;  ///< contains at least the board's ids
  int border_bits = 1;                        ///< width of the black border, in bits
};

/// The smallest dictionary that contains a board's markers, since a smaller one corrects more bit errors.
/// Throws std::invalid_argument for a chessboard, which has no markers.
MarkerDictionary markerDictionary(const BoardSpec& board);

/// Name of this dictionary in OpenCV and in other programs that print boards, such as "DICT_4X4_50"; empty
/// for a chessboard.
std::string dictionaryName(const BoardSpec& board);

/// The black rectangles of a printed calibration board, in board axes (see board_spec.hpp), m. They may touch
/// but do not overlap.
std::vector<cv::Rect2d> boardBlackRectangles(const BoardSpec& board);

}  // namespace cartvo::calib
