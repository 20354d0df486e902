#include "calib/rig_import.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/rig_file.hpp"
#include "calib/rotation.hpp"
#include "calib/strict_yaml.hpp"

namespace cartvo {
namespace {

constexpr int kLargestSide = 8192;

/// Other formats have no rules of their own: what they hold is checked as a rig, under the file's name.
Rig validated(const Rig& rig, const std::filesystem::path& file) {
  try {
    validateRig(rig);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
  return rig;
}

/// The elements of an OpenCV matrix (map of rows, cols, dt, data), row by row.
std::vector<double> readMatrix(const StrictYaml& yaml) {
  const auto rows = yaml["rows"].integer(1, 100);
  const auto columns = yaml["cols"].integer(1, 100);
  return yaml["data"].numbers(static_cast<std::size_t>(rows * columns));
}

std::vector<double> readMatrix(const StrictYaml& yaml, std::size_t count) {
  std::vector<double> values = readMatrix(yaml);
  if (values.size() != count) yaml["data"].failExpecting(std::to_string(count) + " numbers");
  return values;
}

Eigen::Matrix3d rowMajor(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
}

Eigen::Matrix3d rotationFrom(const Eigen::Matrix3d& matrix, const StrictYaml& yaml) {
  if (!isRotation(matrix)) yaml.failExpecting("a rotation with orthonormal rows");
  return nearestRotation(matrix);
}

cv::Size readSize(const StrictYaml& yaml) {
  const std::vector<double> size = yaml.numbers(2);
  for (const double side : size) {
    if (!(side >= 16 && side <= kLargestSide)) yaml.failExpecting("[width, height] from 16 to 8192 px");
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

void setDistortion(const std::vector<double>& coefficients, const StrictYaml& yaml, CameraModel& camera) {
  const std::size_t used = std::min(coefficients.size(), camera.distortion.size());
  std::copy_n(coefficients.begin(), used, camera.distortion.begin());
  const auto beyond = coefficients.begin() + static_cast<std::ptrdiff_t>(used);
  if (std::any_of(beyond, coefficients.end(), [](double coefficient) { return coefficient != 0.0; })) {
    yaml.failExpecting(
        "at most 8 coefficients (k1 k2 p1 p2 k3 k4 k5 k6); thin-prism and tilt ones are not known");
  }
}

CameraModel readOpenCvCamera(const StrictYaml& yaml, const std::string& number, cv::Size size) {
  const std::vector<double> K = readMatrix(yaml["K" + number], 9);
  CameraModel camera;
  camera.size = size;
  camera.fx = K[0];
  camera.fy = K[4];
  camera.cx = K[2];
  camera.cy = K[5];
  setDistortion(readMatrix(yaml["D" + number]), yaml["D" + number], camera);
  return camera;
}

struct EurocCamera {
  CameraModel model;
  Eigen::Isometry3d T_BS = Eigen::Isometry3d::Identity();
};

EurocCamera readEurocCamera(const std::filesystem::path& file) {
  const StrictYaml yaml = StrictYaml::readFile(file);
  const auto expect = [&](const char* key, const std::string& value) {
    if (yaml[key].text() != value) yaml[key].failExpecting("'" + value + "'");
  };
  expect("camera_model", "pinhole");
  expect("distortion_model", "radial-tangential");
  EurocCamera camera;
  camera.model.size = readSize(yaml["resolution"]);
  const std::vector<double> intrinsics = yaml["intrinsics"].numbers(4);
  camera.model.fx = intrinsics[0];
  camera.model.fy = intrinsics[1];
  camera.model.cx = intrinsics[2];
  camera.model.cy = intrinsics[3];
  setDistortion(yaml["distortion_coefficients"].numbers(), yaml["distortion_coefficients"], camera.model);
  const std::vector<double> matrix = readMatrix(yaml["T_BS"], 16);
  const Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(matrix.data());
  camera.T_BS.linear() = rotationFrom(T.topLeftCorner<3, 3>(), yaml["T_BS"]);
  camera.T_BS.translation() = T.topRightCorner<3, 1>();
  return camera;
}

using Projection = std::vector<double>;  ///< 3x4, row by row

std::map<std::string, Projection> readProjections(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read; does the file exist?");
  std::map<std::string, Projection> projections;
  std::string line;
  for (int number = 1; std::getline(stream, line) && number <= 100; ++number) {
    if (!line.starts_with("P0:") && !line.starts_with("P1:")) continue;
    std::istringstream values(line.substr(3));
    Projection P;
    for (double value = 0.0; P.size() <= 12 && values >> value;)
      P.push_back(value);
    const bool is_camera = P.size() == 12 && values.eof() && P[0] > 0.0 && P[0] == P[5] && P[1] == 0.0 &&
                           P[4] == 0.0 && P[8] == 0.0 && P[9] == 0.0 && P[10] == 1.0;
    if (!is_camera) {
      throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": " + line.substr(0, 2) +
                               ": expected 12 numbers, the rows of [f 0 cx -f*b; 0 f cy 0; 0 0 1 0]");
    }
    projections[line.substr(0, 2)] = P;
  }
  return projections;
}

}  // namespace

Rig readOpenCvRig(const std::filesystem::path& file) {
  return openCvRig(StrictYaml::readFile(file), file);
}

Rig openCvRig(const StrictYaml& yaml, const std::filesystem::path& name) {
  const cv::Size size = readSize(yaml["image_size"]);
  Rig rig;
  rig.name = name.stem().string();
  rig.left = readOpenCvCamera(yaml, "1", size);
  rig.right = readOpenCvCamera(yaml, "2", size);
  rig.T_right_left.linear() = rotationFrom(rowMajor(readMatrix(yaml["R"], 9)), yaml["R"]);
  const std::vector<double> T = readMatrix(yaml["T"], 3);
  rig.T_right_left.translation() = Eigen::Vector3d(T[0], T[1], T[2]);
  rig.T_body_camera = forwardLookingMount();
  return validated(rig, name);
}

Rig readEurocRig(const std::filesystem::path& left_sensor, const std::filesystem::path& right_sensor) {
  const EurocCamera left = readEurocCamera(left_sensor);
  const EurocCamera right = readEurocCamera(right_sensor);
  Rig rig;
  rig.name = "EuRoC";
  rig.left = left.model;
  rig.right = right.model;
  rig.T_right_left = right.T_BS.inverse() * left.T_BS;
  rig.T_body_camera = forwardLookingMount();
  return validated(rig, right_sensor);
}

Rig readKittiRig(const std::filesystem::path& calibration, cv::Size image_size) {
  const auto projections = readProjections(calibration);
  if (!projections.contains("P0") || !projections.contains("P1")) {
    throw std::runtime_error(calibration.string() +
                             ": expected the lines 'P0: ...' and 'P1: ...' of a KITTI calib.txt");
  }
  const auto camera_from = [&](const Projection& P) {
    CameraModel camera;
    camera.size = image_size;
    camera.fx = P[0];
    camera.fy = P[5];
    camera.cx = P[2];
    camera.cy = P[6];
    return camera;
  };
  Rig rig;
  rig.name = "KITTI";
  rig.left = camera_from(projections.at("P0"));
  rig.right = camera_from(projections.at("P1"));
  const double centre_left = projections.at("P0")[3] / rig.left.fx;
  const double centre_right = projections.at("P1")[3] / rig.right.fx;
  rig.T_right_left.translation().x() = centre_right - centre_left;
  rig.T_body_camera = forwardLookingMount();
  return validated(rig, calibration);
}

}  // namespace cartvo
