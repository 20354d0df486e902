// Reader and writer for the sensor.yaml files of EuRoC sequences.
#include "calib/format/euroc_rig.hpp"

#include <vector>

#include "calib/format/rig_parts.hpp"
#include "common/exact_text.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

constexpr std::size_t kCoefficients = 4;

struct EurocCamera {
  CameraModel model;
  Eigen::Isometry3d T_BS = Eigen::Isometry3d::Identity();
};

EurocCamera readCamera(const std::filesystem::path& file) {
  const StrictYaml yaml = StrictYaml::readFile(file);
  if (yaml["camera_model"].text() != "pinhole") yaml["camera_model"].failExpecting("'pinhole'");
  EurocCamera camera;
  camera.model.size = readImageSize(yaml["resolution"]);
  readIntrinsics(yaml["intrinsics"], camera.model);
  const std::string model = yaml["distortion_model"].text();
  if (model != "radial-tangential" && model != "radtan" && model != "equidistant")  // radtan: Kimera-VIO
    yaml["distortion_model"].failExpecting("radial-tangential, radtan or equidistant");
  if (model == "equidistant") camera.model.lens = LensModel::wide;
  setDistortion(yaml["distortion_coefficients"].numbers(), yaml["distortion_coefficients"], camera.model);
  camera.T_BS = transformFrom(readMatrix(yaml["T_BS"], 16), yaml["T_BS"]);
  return camera;
}

std::string cameraText(const CameraModel& camera, const Eigen::Isometry3d& T_BS) {
  return "sensor_type: camera\nT_BS:\n  rows: 4\n  cols: 4\n  data: " +
         exactText(rowsOf(Eigen::Matrix4d(T_BS.matrix()))) + "\nresolution: [" +
         std::to_string(camera.size.width) + ", " + std::to_string(camera.size.height) +
         "]\ncamera_model: pinhole\nintrinsics: " + exactText({camera.fx, camera.fy, camera.cx, camera.cy}) +
         "\ndistortion_model: " + (camera.lens == LensModel::wide ? "equidistant" : "radial-tangential") +
         "\ndistortion_coefficients: " +
         exactText(firstCoefficients(camera, kCoefficients, "EuRoC's radial-tangential model")) + "\n";
}

}  // namespace

Rig readEurocRig(const std::filesystem::path& left_sensor, const std::filesystem::path& right_sensor) {
  const EurocCamera left = readCamera(left_sensor);
  const EurocCamera right = readCamera(right_sensor);
  Rig rig;
  rig.name = "EuRoC";
  rig.left = left.model;
  rig.right = right.model;
  rig.T_right_left = right.T_BS.inverse() * left.T_BS;
  return importedRig(rig, right_sensor);
}

EurocText eurocText(const Rig& rig) {
  return {cameraText(rig.left, rig.T_body_camera),
          cameraText(rig.right, rig.T_body_camera * rig.T_right_left.inverse())};
}

}  // namespace cartvo::calib
