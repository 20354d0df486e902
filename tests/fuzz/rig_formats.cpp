// Rig files of other tools: Kalibr, OpenCV, ROS, MATLAB, EuRoC, KITTI; one file, or one for each camera.

#include "calib/rig_formats.hpp"

#include "calib/rig_file.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

namespace {

std::optional<Rig> read(const std::vector<std::string>& texts) {
  std::vector<std::filesystem::path> files;
  for (const std::string& text : texts)
    files.push_back(fuzz::writeScratch("rig" + std::to_string(files.size()) + ".yaml", text));
  return fuzz::accepted([&] { return readRigFiles(files, cv::Size(1241, 376)); }, "rig");
}

/// The rig in another format, if that can hold it.
std::optional<std::vector<RigFile>> filesOf(const Rig& rig, RigFormat format) {
  return fuzz::accepted([&] { return rigFilesOf(rig, format); }, "");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::optional<Rig> rig = read(fuzz::partsOf(fuzz::textOf(data, size)));
  if (!rig) return 0;
  validateRig(*rig);
  const std::string text = rigText(*rig);
  fuzz::require(rigText(parseRig(text, "rig.yaml")) == text, "a rig is read back to the last bit");
  // What cartvo writes for another tool it can read again. ROS' files would take a rectification each.
  for (const RigFormat format : {RigFormat::opencv, RigFormat::kalibr, RigFormat::matlab, RigFormat::euroc}) {
    const auto files = filesOf(*rig, format);
    if (!files) continue;
    std::vector<std::string> texts;
    for (const RigFile& file : *files)
      texts.push_back(file.text);
    fuzz::require(read(texts).has_value(), "what rigFilesOf wrote can be read: " + texts.front());
  }
  return 0;
}
