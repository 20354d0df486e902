// The beginning of a recorded stream's file, which tells whether it was ended.

#include "capture/matroska_file.hpp"

#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = fuzz::writeScratch("left.mkv", fuzz::textOf(data, size));
  const bool was_ended = wasEnded(file);
  // EBML's and the segment's identifiers and sizes are ten bytes at least.
  fuzz::require(!was_ended || size >= 10, "only a whole header tells that a file was ended");
  return 0;
}
