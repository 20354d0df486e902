// Fuzz target for recording.json.

#include "capture/recording/recording_folder.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kName = "recording.json";
  const auto info = fuzz::parseOrReject(
      [&] { return capture::parseRecordingInfo(fuzz::toText(data, size), kName); }, kName);
  if (!info) return 0;
  fuzz::require(info->format_version == capture::kRecordingFormatVersion, "other formats are rejected");
  return 0;
}
