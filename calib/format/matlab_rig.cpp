// Reader and writer for MATLAB's stereoParameters as JSON.
#include "calib/format/matlab_rig.hpp"

#include <map>
#include <stdexcept>
#include <vector>

#include "calib/format/rig_parts.hpp"
#include "common/exact_text.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

constexpr double kFirstPixel = 1.0;  // px; MATLAB counts pixels from one

double metresPerUnit(const StrictYaml& camera) {
  static const std::map<std::string, double> kUnits{
      {"mm", 1e-3}, {"millimeters", 1e-3}, {"cm", 1e-2},   {"centimeters", 1e-2},
      {"m", 1.0},   {"meters", 1.0},       {"in", 0.0254}, {"inches", 0.0254}};
  if (!camera.has("WorldUnits")) return kUnits.at("mm");
  const auto unit = kUnits.find(camera["WorldUnits"].text());
  if (unit == kUnits.end()) camera["WorldUnits"].failExpecting("mm, cm, m or in");
  return unit->second;
}

/// Two or three radial and two tangential coefficients, in OpenCV's order.
std::vector<double> distortionOf(const StrictYaml& yaml) {
  const std::vector<double> radial = yaml["RadialDistortion"].numbers();
  if (radial.size() != 2 && radial.size() != 3)
    yaml["RadialDistortion"].failExpecting("two or three coefficients");
  const std::vector<double> tangential = yaml["TangentialDistortion"].numbers(2);
  return {radial[0], radial[1], tangential[0], tangential[1], radial.size() == 3 ? radial[2] : 0.0};
}

CameraModel readCamera(const StrictYaml& yaml) {
  const cv::Size rows_and_columns = readImageSize(yaml["ImageSize"]);
  CameraModel camera;
  camera.size = {rows_and_columns.height, rows_and_columns.width};
  const StrictYaml matrix = yaml["IntrinsicMatrix"];
  const std::vector<double> K = matrix.numbers(9);
  if (K[6] == 0.0 && K[7] == 0.0 && (K[2] != 0.0 || K[5] != 0.0))
    matrix.failExpecting("[fx 0 0; skew fy 0; cx cy 1], as MATLAB writes it: exchange rows and columns");
  setCameraMatrix({K[0], K[3], K[6], K[1], K[4], K[7], K[2], K[5], K[8]}, matrix, camera);
  camera.cx -= kFirstPixel;
  camera.cy -= kFirstPixel;
  setDistortion(distortionOf(yaml), yaml["RadialDistortion"], camera);
  return camera;
}

std::string rowsText(const std::vector<double>& values) {
  std::string text = "[";
  for (std::size_t row = 0; row < values.size() / 3; ++row) {
    text += (row == 0 ? "" : ", ") + exactText({values[3 * row], values[3 * row + 1], values[3 * row + 2]});
  }
  return text + "]";
}

std::string cameraText(const char* name, const CameraModel& camera) {
  constexpr std::size_t kCoefficients = 5;
  if (camera.lens == LensModel::wide)
    throw std::invalid_argument(
        "MATLAB's stereoParameters hold Brown's distortion; this rig's lenses are wide");
  const std::vector<double> k = firstCoefficients(camera, kCoefficients, "MATLAB's cameraParameters");
  return std::string("  \"") + name + "\": {\n    \"IntrinsicMatrix\": " +
         rowsText({camera.fx, 0.0, 0.0, 0.0, camera.fy, 0.0, camera.cx + kFirstPixel, camera.cy + kFirstPixel,
                   1.0}) +
         ",\n    \"RadialDistortion\": " + exactText({k[0], k[1], k[4]}) +
         ",\n    \"TangentialDistortion\": " + exactText({k[2], k[3]}) + ",\n    \"ImageSize\": [" +
         std::to_string(camera.size.height) + ", " + std::to_string(camera.size.width) +
         "],\n    \"WorldUnits\": \"m\"\n  },\n";
}

}  // namespace

Rig parseMatlabRig(const StrictYaml& yaml, const std::filesystem::path& name) {
  Rig rig;
  rig.name = name.stem().string();
  rig.left = readCamera(yaml["CameraParameters1"]);
  rig.right = readCamera(yaml["CameraParameters2"]);
  const StrictYaml rotation = yaml["RotationOfCamera2"];
  rig.T_right_left.linear() = rotationFrom(rotation.numbers(9), rotation).transpose();
  const std::vector<double> t = yaml["TranslationOfCamera2"].numbers(3);
  rig.T_right_left.translation() =
      metresPerUnit(yaml["CameraParameters1"]) * Eigen::Vector3d(t[0], t[1], t[2]);
  return importedRig(rig, name);
}

std::string matlabText(const Rig& rig) {
  const Eigen::Vector3d& t = rig.T_right_left.translation();
  return "{\n" + cameraText("CameraParameters1", rig.left) + cameraText("CameraParameters2", rig.right) +
         "  \"RotationOfCamera2\": " +
         rowsText(rowsOf(Eigen::Matrix3d(rig.T_right_left.linear().transpose()))) +
         ",\n  \"TranslationOfCamera2\": " + exactText({t.x(), t.y(), t.z()}) + "\n}\n";
}

}  // namespace cartvo::calib
