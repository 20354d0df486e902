// recording.json, which says what a recording is.

#include "capture/recording_folder.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kName = "recording.json";
  const auto info =
      fuzz::accepted([&] { return parseRecordingInfo(fuzz::textOf(data, size), kName); }, kName);
  if (!info) return 0;
  fuzz::require(info->format_version == kRecordingFormatVersion, "other formats are refused");
  return 0;
}
