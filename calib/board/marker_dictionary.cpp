// Choice of the OpenCV marker dictionary for a board.
#include "calib/board/marker_dictionary.hpp"

#include <array>
#include <stdexcept>

namespace cartvo::calib {
namespace {

/// OpenCV's dictionaries of 50, 100, 250 and 1000 markers of n x n bits start with the same codes, and their
/// enumerators are consecutive, starting with 4x4.
MarkerDictionary charucoDictionary(const Charuco& board) {
  constexpr int kMinBits = 4;
  constexpr std::array kSizes{50, 100, 250, 1000};
  const int markers = board.columns * board.rows / 2;
  int index = 0;
  while (index + 1 < static_cast<int>(kSizes.size()) && kSizes[static_cast<std::size_t>(index)] < markers)
    ++index;
  const int name =
      cv::aruco::DICT_4X4_50 + static_cast<int>(kSizes.size()) * (board.marker_bits - kMinBits) + index;
  return {cv::aruco::getPredefinedDictionary(name), 1};
}

}  // namespace

MarkerDictionary markerDictionary(const BoardSpec& board) {
  if (const auto* charuco = std::get_if<Charuco>(&board)) return charucoDictionary(*charuco);
  if (std::holds_alternative<AprilGrid>(board)) {
    return {cv::aruco::getPredefinedDictionary(cv::aruco::DICT_APRILTAG_36h11), 2};
  }
  throw std::invalid_argument("a chessboard has no markers");
}

}  // namespace cartvo::calib
