// Readers and writers for Kalibr's camchain.yaml and the sensor.yaml of EuRoC.
#include "calib/format/kalibr_rig.hpp"

#include <optional>
#include <vector>

#include "calib/format/rig_parts.hpp"
#include "common/exact_text.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

constexpr std::size_t kCoefficients = 4;

CameraModel readCamera(const StrictYaml& yaml) {
  if (yaml["camera_model"].text() != "pinhole") yaml["camera_model"].failExpecting("'pinhole'");
  CameraModel camera;
  camera.size = readImageSize(yaml["resolution"]);
  readIntrinsics(yaml["intrinsics"], camera);
  const std::string model = yaml["distortion_model"].text();
  if (model == "none") return camera;
  if (model != "radtan" && model != "equidistant")
    yaml["distortion_model"].failExpecting("radtan, equidistant or none");
  if (model == "equidistant") camera.lens = LensModel::wide;
  setDistortion(yaml["distortion_coeffs"].numbers(kCoefficients), yaml["distortion_coeffs"], camera);
  return camera;
}

std::string cameraText(const CameraModel& camera, int number) {
  const std::string other = std::to_string(1 - number);
  return "  cam_overlaps: [" + other + "]\n  camera_model: pinhole\n  distortion_coeffs: " +
         exactText(firstCoefficients(camera, kCoefficients, "Kalibr's radtan model")) +
         "\n  distortion_model: " + (camera.lens == LensModel::wide ? "equidistant" : "radtan") +
         "\n  intrinsics: " + exactText({camera.fx, camera.fy, camera.cx, camera.cy}) + "\n  resolution: [" +
         std::to_string(camera.size.width) + ", " + std::to_string(camera.size.height) +
         "]\n  rostopic: /cam" + std::to_string(number) + "/image_raw\n";
}

std::string transformText(const Eigen::Isometry3d& transform) {
  std::string text;
  for (int row = 0; row < 4; ++row) {
    const Eigen::Vector4d values = transform.matrix().row(row);
    text += "  - " + exactText({values[0], values[1], values[2], values[3]}) + "\n";
  }
  return text;
}

Eigen::Isometry3d readTransform(const StrictYaml& yaml) {
  return transformFrom(yaml.numbers(16), yaml);
}

/// T_cam_imu of a camera: Kalibr's own key, or OpenVINS' T_imu_cam; nothing if it has neither.
std::optional<Eigen::Isometry3d> cameraFromImu(const StrictYaml& camera) {
  if (camera.has("T_cam_imu")) return readTransform(camera["T_cam_imu"]);
  if (camera.has("T_imu_cam")) return readTransform(camera["T_imu_cam"]).inverse();
  return std::nullopt;
}

/// Throws std::runtime_error unless both transforms are equal within the rounding of files.
void requireEqual(const Eigen::Isometry3d& chained, const Eigen::Isometry3d& by_imu, const StrictYaml& yaml) {
  constexpr double kMaxDistance = 1e-3, kMaxAngle = 2e-3;  // m, rad
  const Eigen::Isometry3d difference = chained.inverse() * by_imu;
  if (difference.translation().norm() <= kMaxDistance &&
      Eigen::AngleAxisd(difference.linear()).angle() <= kMaxAngle)
    return;
  yaml.fail("differs from the transform that both cameras' transforms against the IMU give, by " +
            exactText(difference.translation().norm()) + " m and " +
            exactText(Eigen::AngleAxisd(difference.linear()).angle()) +
            " rad; remove the wrong one of the two");
}

Eigen::Isometry3d readRightFromLeft(const StrictYaml& left, const StrictYaml& right) {
  const std::optional<Eigen::Isometry3d> left_imu = cameraFromImu(left), right_imu = cameraFromImu(right);
  std::optional<Eigen::Isometry3d> by_imu;
  if (left_imu && right_imu) by_imu = *right_imu * left_imu->inverse();
  if (!right.has("T_cn_cnm1")) {
    if (by_imu) return *by_imu;
    right.fail(
        "has no T_cn_cnm1 (against cam0), nor have both cameras T_cam_imu or T_imu_cam (against the IMU)");
  }
  const StrictYaml yaml = right["T_cn_cnm1"];
  Eigen::Isometry3d chained = readTransform(yaml);
  if (by_imu) requireEqual(chained, *by_imu, yaml);
  return chained;
}

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

std::string sensorText(const CameraModel& camera, const Eigen::Isometry3d& T_BS) {
  return "sensor_type: camera\nT_BS:\n  rows: 4\n  cols: 4\n  data: " +
         exactText(rowsOf(Eigen::Matrix4d(T_BS.matrix()))) + "\nresolution: [" +
         std::to_string(camera.size.width) + ", " + std::to_string(camera.size.height) +
         "]\ncamera_model: pinhole\nintrinsics: " + exactText({camera.fx, camera.fy, camera.cx, camera.cy}) +
         "\ndistortion_model: " + (camera.lens == LensModel::wide ? "equidistant" : "radial-tangential") +
         "\ndistortion_coefficients: " +
         exactText(firstCoefficients(camera, kCoefficients, "EuRoC's radial-tangential model")) + "\n";
}

}  // namespace

Rig parseKalibrRig(const StrictYaml& yaml, const std::filesystem::path& name) {
  Rig rig;
  rig.name = name.stem().string();
  rig.left = readCamera(yaml["cam0"]);
  rig.right = readCamera(yaml["cam1"]);
  rig.T_right_left = readRightFromLeft(yaml["cam0"], yaml["cam1"]);
  return importedRig(rig, name);
}

std::string kalibrText(const Rig& rig) {
  return "cam0:\n" + cameraText(rig.left, 0) + "cam1:\n  T_cn_cnm1:\n" + transformText(rig.T_right_left) +
         cameraText(rig.right, 1);
}

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
  return {sensorText(rig.left, rig.T_body_camera),
          sensorText(rig.right, rig.T_body_camera * rig.T_right_left.inverse())};
}

}  // namespace cartvo::calib
