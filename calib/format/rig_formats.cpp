// Rig formats of other tools: detection, reading and writing.
#include "calib/format/rig_formats.hpp"

#include <algorithm>
#include <stdexcept>

#include "calib/format/euroc_rig.hpp"
#include "calib/format/kalibr_rig.hpp"
#include "calib/format/kitti_rig.hpp"
#include "calib/format/matlab_rig.hpp"
#include "calib/format/opencv_rig.hpp"
#include "calib/format/other_rigs.hpp"
#include "calib/format/rig_file.hpp"
#include "calib/format/rig_parts.hpp"
#include "calib/format/ros_rig.hpp"
#include "calib/model/rig_validation.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

namespace fs = std::filesystem;

Rig readOneFile(const fs::path& file, const RigReading& reading) {
  const StrictYaml yaml = readYamlOrXml(file);
  if (yaml.has("cartvo_rig")) return parseCartvoRig(yaml, file.parent_path());
  if (isKittiRig(yaml) && !isOpenCvRig(yaml))
    return parseKittiRig(yaml, file, reading.image_size, reading.cameras);
  if (const std::optional<Rig> rig = parseForeignRig(yaml, file, reading.image_size)) return *rig;
  if (yaml.has("T_BS") || isRosCamera(yaml)) {
    throw std::runtime_error(file.string() +
                             ": holds one camera only: give the left and the right camera's file");
  }
  throw std::runtime_error(file.string() + ": is in none of the known formats: " + kKnownRigFormats);
}

Rig readTwoFiles(const fs::path& first, const fs::path& second, const RigReading& reading) {
  const StrictYaml yaml = readYamlOrXml(first), other = readYamlOrXml(second);
  if (yaml.has("T_BS")) return readEurocRig(first, second);
  if (isOpenCvRig(yaml) && isOpenCvRig(other))
    return parseOpenCvRig({yaml, other}, first, reading.image_size);
  if (isRosCamera(yaml)) return readRosRig(first, second);
  throw std::runtime_error(first.string() + " and " + second.string() +
                           ": two files are OpenCV's intrinsics (K1 or M1) and extrinsics (R, T), or the "
                           "left and the right camera's: "
                           "EuRoC's sensor.yaml (T_BS) or ROS' camera_info (camera_matrix or K)");
}

Rig readAnyFiles(const std::vector<fs::path>& files, const RigReading& reading) {
  if (files.size() == 1) return readOneFile(files[0], reading);
  if (files.size() == 2) return readTwoFiles(files[0], files[1], reading);
  throw std::runtime_error("a rig is one file, or the left and the right camera's");
}

}  // namespace

const std::vector<std::string>& rigFormatNames() {
  static const std::vector<std::string> kNames{"cartvo", "opencv", "kalibr", "matlab",
                                               "kitti",  "ros",    "euroc"};
  return kNames;
}

RigFormat parseRigFormat(const std::string& name) {
  const auto& names = rigFormatNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::invalid_argument("there is no rig format '" + name + "'");
  return static_cast<RigFormat>(found - names.begin());
}

Rig readRigFiles(const std::vector<fs::path>& files, const RigReading& reading) {
  Rig rig = readAnyFiles(files, reading);
  const std::string finding = unusualGeometry(rig);
  if (finding.empty() || rig.unusual_geometry) return rig;
  if (!reading.unusual_geometry) {
    throw std::runtime_error(files.back().string() + ": " + finding +
                             " If the rig is really so, convert it with --unusual-geometry");
  }
  rig.unusual_geometry = true;
  return rig;
}

std::vector<RigFile> rigFilesOf(const Rig& rig, RigFormat format) {
  validateRig(rig);
  switch (format) {
    case RigFormat::opencv:
      return {{"", openCvText(rig)}};
    case RigFormat::kalibr:
      return {{"", kalibrText(rig)}};
    case RigFormat::matlab:
      return {{"", matlabText(rig)}};
    case RigFormat::kitti:
      return {{"", kittiText(rig)}};
    case RigFormat::ros: {
      const RosText text = rosText(rig);
      return {{"left.yaml", text.left}, {"right.yaml", text.right}};
    }
    case RigFormat::euroc: {
      const EurocText text = eurocText(rig);
      return {{"cam0/sensor.yaml", text.left}, {"cam1/sensor.yaml", text.right}};
    }
    default:
      return {{"", rigText(rig)}};
  }
}

}  // namespace cartvo::calib
