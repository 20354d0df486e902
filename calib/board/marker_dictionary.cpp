// Choice of the OpenCV marker dictionary for a board.
#include "calib/board/marker_dictionary.hpp"

#include <array>
#include <stdexcept>

namespace cartvo::calib {
namespace {

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

}  // namespace

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

}  // namespace cartvo::calib
