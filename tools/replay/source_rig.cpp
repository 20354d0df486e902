// Finds the rig of a source.

#include "tools/replay/source_rig.hpp"

#include <stdexcept>

#include <opencv2/core/mat.hpp>

#include "calib/format/euroc_rig.hpp"
#include "calib/format/kitti_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "capture/dataset/image_folder.hpp"

namespace cartvo {
namespace {

/// Size of the first image, px: KITTI's calib.txt does not contain the image size.
cv::Size firstImageSize(const std::filesystem::path& folder) {
  return capture::readGreyImage(capture::readImageFolder(folder).left.images.front()).size();
}

}  // namespace

FoundRig findRig(const capture::StereoSource& source, const std::filesystem::path& path,
                 const std::filesystem::path& given) {
  const std::filesystem::path& rig_file = given.empty() ? source.rig_file : given;
  if (!rig_file.empty()) return {calib::readRig(rig_file), rig_file.string()};
  if (!source.rig_text.empty()) {
    const std::filesystem::path recording = path / "recording.json";
    return {calib::parseRig(source.rig_text, recording), recording.string()};
  }
  const auto& [left_sensor, right_sensor] = source.sensor_files;
  if (!left_sensor.empty() && !right_sensor.empty()) {
    return {calib::readEurocRig(left_sensor, right_sensor), left_sensor.string()};
  }
  if (!source.calib_file.empty()) {
    return {calib::readKittiRig(source.calib_file, firstImageSize(path)), source.calib_file.string()};
  }
  throw std::runtime_error(path.string() +
                           ": no rig file found. Give --rig FILE, or put a rig.yaml (cartvo's own or "
                           "OpenCV's K1 D1 K2 D2 R T image_size) or KITTI's calib.txt into the folder");
}

}  // namespace cartvo
