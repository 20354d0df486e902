#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <variant>
#include <vector>

namespace cartvo {

/// A chessboard, counted as OpenCV does: by the corners at which four squares meet.
struct Chessboard {
  int columns = 0, rows = 0;  ///< inner corners
  double square = 0.0;        ///< side of a square, m

  bool operator==(const Chessboard&) const = default;
};

/// A chessboard with an ArUco marker in each white square, as cv::aruco::CharucoBoard has it: the top left
/// square is black, markers are numbered by rows from the top left.
struct Charuco {
  int columns = 0, rows = 0;  ///< squares
  double square = 0.0;        ///< side of a square, m
  double marker = 0.0;        ///< side of a marker with its black border, m
  int marker_bits = 4;        ///< along a marker's side, without its border: 4 to 7

  bool operator==(const Charuco&) const = default;
};

/// Kalibr's AprilGrid: tags 36h11 with a border of two bits, numbered by rows from the bottom left, and a
/// small black square where four gaps meet, so that each tag's corners are crossings.
struct AprilGrid {
  int columns = 0, rows = 0;  ///< tags
  double tag = 0.0;           ///< side of a tag with its black border, m
  double spacing = 0.0;       ///< gap between tags, in sides of a tag

  bool operator==(const AprilGrid&) const = default;
};

using BoardSpec = std::variant<Chessboard, Charuco, AprilGrid>;

/// Reads chessboard:COLUMNSxROWS:SQUARE, charuco:COLUMNSxROWS:SQUARE:MARKER[:BITSxBITS] or
/// aprilgrid:COLUMNSxROWS:TAG:SPACING, lengths in metres. Throws std::invalid_argument naming the text, what
/// is wrong with it and what was expected.
BoardSpec parseBoardSpec(const std::string& text);

/// The text that `parseBoardSpec` reads; the same board to the last bit.
std::string boardSpecText(const BoardSpec& board);

// Board axes: x right, y down as the board is looked at, z through the paper away from the viewer; the origin
// is the top left corner of the printed pattern. Metres. All points have z = 0, which is left out.

/// Width and height of the printed pattern: from the outer squares' edges, or the small black squares'.
Eigen::Vector2d boardExtent(const BoardSpec& board);

/// The corners that are looked for, each at its id: for a chessboard and ChArUco the inner corners by rows
/// from the top left (as cv::findChessboardCorners and cv::aruco count them), for an AprilGrid the corners k
/// of tag i at 4 i + k, in the order of `BoardMarker::corners`.
std::vector<Eigen::Vector2d> boardCorners(const BoardSpec& board);

/// A coded square on a board.
struct BoardMarker {
  int id = 0;
  /// In the order of cv::aruco::detectMarkers: a ChArUco's marker from its top left clockwise; an AprilGrid's
  /// tag from its bottom right clockwise, for Kalibr prints it upside down to how OpenCV holds it.
  std::array<Eigen::Vector2d, 4> corners;
};

/// Each marker at its id; none on a chessboard.
std::vector<BoardMarker> boardMarkers(const BoardSpec& board);

}  // namespace cartvo
