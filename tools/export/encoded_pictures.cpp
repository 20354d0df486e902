// Reads the encoded pictures of a recording for other programs.
#include "tools/export/encoded_pictures.hpp"

#include "capture/codec/nal_units.hpp"

namespace cartvo {

EncodedPictures::EncodedPictures(const std::filesystem::path& recording, capture::CameraSide side)
    : reader_(recording, side) {
  do {
    advance();
  } while (!finished_ && !recorded_.unit.key);
}

const char* EncodedPictures::codec() const {
  return recorded_.format.codec == capture::VideoCodec::h264 ? "h264" : "h265";
}

void EncodedPictures::addParameterSets() {
  std::vector<std::uint8_t>& data = recorded_.unit.data;
  const std::vector<std::uint8_t> own = capture::parameterSets(recorded_.format.codec, data);
  if (!own.empty()) {
    parameter_sets_ = own;
    return;
  }
  const std::vector<std::uint8_t>& sets =
      parameter_sets_.empty() ? recorded_.format.parameter_sets : parameter_sets_;
  data.insert(data.begin(), sets.begin(), sets.end());
}

void EncodedPictures::advance() {
  finished_ = !reader_.next(recorded_);
  if (!finished_ && recorded_.unit.key) addParameterSets();
}

}  // namespace cartvo
