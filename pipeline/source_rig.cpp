// Finds the rig of a source.

#include "pipeline/source_rig.hpp"

#include <stdexcept>

#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "capture/dataset/image_files.hpp"

namespace cartvo::pipeline {
FoundRig findRig(const capture::StereoSource& source, const std::filesystem::path& path,
                 const std::filesystem::path& given) {
  calib::RigReading reading;
  reading.cameras = source.cameras;
  if (!source.first_image.empty())
    reading.image_size = capture::partOf(capture::readGreyImage(source.first_image), source.part).size();
  if (!given.empty()) return {calib::readRigFiles({given}, reading), given.string()};
  if (!source.rig_file.empty()) return {calib::readRig(source.rig_file), source.rig_file.string()};
  if (!source.rig_text.empty()) {
    const std::filesystem::path recording = path / "recording.json";
    return {calib::parseRig(source.rig_text, recording), recording.string()};
  }
  const auto& [left_sensor, right_sensor] = source.sensor_files;
  if (!left_sensor.empty() && !right_sensor.empty())
    return {calib::readRigFiles({left_sensor, right_sensor}), left_sensor.string()};
  if (!source.calib_file.empty())
    return {calib::readRigFiles({source.calib_file}, reading), source.calib_file.string()};
  if (!std::filesystem::is_directory(path))
    throw std::runtime_error(path.string() + ": no rig file found. Give the cameras' by --rig FILE");
  throw std::runtime_error(
      path.string() +
      ": no rig file found. Give --rig FILE, or put a rig.yaml (cartvo's own or OpenCV's K1 D1 K2 D2 R T "
      "image_size), KITTI's calib.txt or Kalibr's camchain.yaml into the folder, or EuRoC's sensor.yaml into "
      "mav0/cam0 and mav0/cam1");
}

}  // namespace cartvo::pipeline
