// Board detection: calls the detector of the board's kind.
#include "calib/board/board_detection.hpp"

#include "calib/board/chessboard_detection.hpp"
#include "calib/board/marker_detection.hpp"

namespace cartvo::calib {

std::vector<SeenCorner> detectBoard(const cv::Mat& grey, const BoardSpec& board) {
  if (const auto* const chessboard = std::get_if<Chessboard>(&board))
    return detectChessboard(grey, *chessboard);
  if (const auto* const charuco = std::get_if<Charuco>(&board)) return detectCharuco(grey, *charuco);
  return detectAprilGrid(grey, std::get<AprilGrid>(board));
}

std::string describeOtherBoard(const cv::Mat& grey, const BoardSpec& board) {
  if (std::holds_alternative<Chessboard>(board)) return describeChessboard(grey);
  return describeUnknownMarker(grey, board);
}

}  // namespace cartvo::calib
