// Fuzz target for the header of a recorded video file, which shows whether it was finalised.

#include "capture/recording/recording_summary.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::writeScratch("left.mkv", fuzz::toText(data, size));
  const bool is_finalised = capture::isMatroskaFinalised(file);
  // The identifiers and sizes of EBML and of the segment are at least ten bytes.
  fuzz::require(!is_finalised || size >= 10, "only a complete header shows that a file was finalised");
  return 0;
}
