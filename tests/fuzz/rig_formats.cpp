// Fuzz target for rig files of other tools: Kalibr, OpenCV, ROS, MATLAB, EuRoC, KITTI; one file, or one per
// camera.

#include "calib/format/rig_formats.hpp"

#include "calib/format/rig_file.hpp"
#include "calib/model/rig_validation.hpp"
#include "tests/fuzz/fuzzing.hpp"

using namespace cartvo;

namespace {

/// `image_size`: for files that do not contain it.
std::optional<calib::Rig> read(const std::vector<std::string>& texts, cv::Size image_size) {
  std::vector<std::filesystem::path> files;
  for (const std::string& text : texts)
    files.push_back(fuzz::writeScratch("rig" + std::to_string(files.size()) + ".yaml", text));
  return fuzz::parseOrReject(
      [&] { return calib::readRigFiles(files, {.image_size = image_size, .unusual_geometry = true}); },
      "rig");
}

/// The rig in another format, if that can represent it.
std::optional<std::vector<calib::RigFile>> toFiles(const calib::Rig& rig, calib::RigFormat format) {
  return fuzz::parseOrReject([&] { return calib::rigFilesOf(rig, format); }, "");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::optional<calib::Rig> rig = read(fuzz::splitParts(fuzz::toText(data, size)), {1241, 376});
  if (!rig) return 0;
  calib::validateRig(*rig);
  const std::string text = calib::rigText(*rig);
  fuzz::require(calib::rigText(calib::parseRig(text, "rig.yaml")) == text,
                "a rig is read back to the last bit");
  // Files that cartvo writes for other tools can be read again. ROS' files would need a rectification each.
  for (const calib::RigFormat format : {calib::RigFormat::opencv, calib::RigFormat::kalibr,
                                        calib::RigFormat::matlab, calib::RigFormat::euroc}) {
    const auto files = toFiles(*rig, format);
    if (!files) continue;
    std::vector<std::string> texts;
    for (const calib::RigFile& file : *files)
      texts.push_back(file.text);
    fuzz::require(read(texts, rig->left.size).has_value(),
                  "what rigFilesOf wrote can be read: " + texts.front());
  }
  return 0;
}
