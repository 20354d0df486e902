// Rig formats of other tools: detection, reading and writing.
#include "calib/format/rig_formats.hpp"

#include <algorithm>
#include <stdexcept>

#include "calib/format/euroc_rig.hpp"
#include "calib/format/kalibr_rig.hpp"
#include "calib/format/kitti_rig.hpp"
#include "calib/format/matlab_rig.hpp"
#include "calib/format/opencv_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "calib/format/ros_rig.hpp"
#include "calib/model/rig_validation.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

namespace fs = std::filesystem;

Rig readOneFile(const fs::path& file, std::optional<cv::Size> image_size) {
  const StrictYaml yaml = StrictYaml::readFile(file);
  if (yaml.has("P0")) {
    if (!image_size) {
      throw std::runtime_error(file.string() +
                               ": KITTI's calib.txt does not contain the image size: give their size");
    }
    return readKittiRig(file, *image_size);
  }
  if (yaml.has("T_BS") || yaml.has("camera_matrix")) {
    throw std::runtime_error(file.string() +
                             ": holds one camera only: give the left and the right camera's file");
  }
  return readRig(file);
}

Rig readTwoFiles(const fs::path& left, const fs::path& right) {
  const StrictYaml yaml = StrictYaml::readFile(left);
  if (yaml.has("T_BS")) return readEurocRig(left, right);
  if (yaml.has("camera_matrix")) return readRosRig(left, right);
  throw std::runtime_error(
      left.string() +
      ": is neither a EuRoC sensor.yaml (key T_BS) nor a ROS camera_info (camera_matrix); "
      "other formats are one file");
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

Rig readRigFiles(const std::vector<fs::path>& files, std::optional<cv::Size> image_size) {
  if (files.size() == 1) return readOneFile(files[0], image_size);
  if (files.size() == 2) return readTwoFiles(files[0], files[1]);
  throw std::runtime_error("a rig is one file, or the left and the right camera's");
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
