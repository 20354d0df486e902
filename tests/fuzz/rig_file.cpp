// Fuzz target for cartvo's rig files, as read from disk and from recordings.

#include "calib/format/rig_file.hpp"

#include "calib/model/rig_validation.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kName = "rig.yaml";
  const auto rig =
      fuzz::parseOrReject([&] { return calib::parseRig(fuzz::toText(data, size), kName); }, kName);
  if (!rig) return 0;
  calib::validateRig(*rig);
  const std::string text = calib::rigText(*rig);
  fuzz::require(calib::rigText(calib::parseRig(text, kName)) == text, "a rig is read back to the last bit");
  return 0;
}
