// Fuzz target for the specification of a calibration board, as given on the command line.

#include "calib/board/board_spec.hpp"

#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = fuzz::toText(data, size);
  if (text.find('\0') != std::string::npos) return 0;  // a program argument cannot contain a null character
  const auto board = fuzz::parseOrReject([&] { return calib::parseBoardSpec(text); }, text);
  if (!board) return 0;
  fuzz::require(calib::parseBoardSpec(calib::boardSpecText(*board)) == *board,
                "a board is read back to the last bit");
  fuzz::require(calib::boardExtent(*board).allFinite() && !calib::boardCorners(*board).empty(),
                "a board has corners");
  calib::boardMarkers(*board);
  return 0;
}
