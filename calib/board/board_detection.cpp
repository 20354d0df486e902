// Board detection: calls the detector of the board's kind.
#include "calib/board/board_detection.hpp"

#include <optional>
#include <utility>

#include "calib/board/chessboard_detection.hpp"
#include "calib/board/marker_detection.hpp"
#include "common/image_size.hpp"

namespace cartvo::calib {
namespace {

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
