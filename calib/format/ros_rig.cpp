// Reader and writer for ROS camera_info files of a stereo pair.
#include "calib/format/ros_rig.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "calib/format/rig_parts.hpp"
#include "calib/model/rig_validation.hpp"
#include "calib/rectification/rectification.hpp"
#include "common/exact_text.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

constexpr std::size_t kPlumbBob = 5;  // k1 k2 p1 p2 k3

/// Names of the values in the calibrator's files, and in messages of the topic camera_info (ROS 1 and 2).
struct RosKeys {
  const char *width, *height, *K, *D, *R, *P;
};
constexpr std::array<RosKeys, 3> kRosKeys{
    {{"image_width", "image_height", "camera_matrix", "distortion_coefficients", "rectification_matrix",
      "projection_matrix"},
     {"width", "height", "K", "D", "R", "P"},
     {"width", "height", "k", "d", "r", "p"}}};

/// The names that a file uses; those of the calibrator's files if it is no camera_info.
const RosKeys& keysOf(const StrictYaml& yaml) {
  const auto keys = std::find_if(kRosKeys.begin(), kRosKeys.end(), [&yaml](const RosKeys& names) {
    return yaml.has(names.K) && yaml.has(names.P);
  });
  return keys == kRosKeys.end() ? kRosKeys.front() : *keys;
}

/// One camera and its rectification.
struct RosCamera {
  CameraModel model;
  CameraModel rectified;  ///< focal length and principal point after rectification
  Eigen::Matrix3d R_rectified_camera;
  double centre = 0.0;  ///< position of the camera along the rectified x axis, m
};

/// Drivers of cameras whose pictures are rectified leave model and coefficients empty.
LensModel readLens(const StrictYaml& yaml, const std::vector<double>& coefficients) {
  const std::string model = yaml.text();
  if (model.empty() && coefficients.empty()) return LensModel::brown;
  if (model == "equidistant") return LensModel::wide;
  if (model != "plumb_bob" && model != "rational_polynomial")
    yaml.failExpecting("plumb_bob, rational_polynomial or equidistant");
  return LensModel::brown;
}

/// Throws std::runtime_error for images that are a part of the calibrated ones (sensor_msgs/CameraInfo:
/// binning and region of interest), for which the other numbers would have to be converted. A region of the
/// whole image is no part.
void refusePartOfImage(const StrictYaml& yaml, cv::Size size) {
  constexpr std::int64_t kMax = 1'000'000;
  for (const char* const key : {"binning_x", "binning_y"}) {
    if (yaml.has(key) && yaml[key].integer(0, kMax) > 1)
      yaml[key].fail("images with binning are not read; calibrate at the size that is used");
  }
  if (!yaml.has("roi")) return;
  for (const auto& [key, whole] : {std::pair("x_offset", 0), std::pair("y_offset", 0),
                                   std::pair("width", size.width), std::pair("height", size.height)}) {
    const std::int64_t value = yaml["roi"].has(key) ? yaml["roi"][key].integer(0, kMax) : 0;
    if (value != 0 && value != whole)
      yaml["roi"][key].fail("a region of interest is not read; calibrate at the size that is used");
  }
}

RosCamera readCamera(const std::filesystem::path& file) {
  const StrictYaml yaml = readYamlOrXml(file);
  const RosKeys& keys = keysOf(yaml);
  RosCamera camera;
  camera.model.size = {static_cast<int>(yaml[keys.width].integer(kMinImageSide, kMaxImageSide)),
                       static_cast<int>(yaml[keys.height].integer(kMinImageSide, kMaxImageSide))};
  refusePartOfImage(yaml, camera.model.size);
  setCameraMatrix(readMatrix(yaml[keys.K], 9), yaml[keys.K], camera.model);
  const StrictYaml distortion = yaml[keys.D];
  const std::vector<double> coefficients = readMatrix(distortion);
  camera.model.lens = readLens(yaml["distortion_model"], coefficients);
  const bool has_more = yaml["distortion_model"].text() == "plumb_bob" && coefficients.size() > kPlumbBob &&
                        std::any_of(coefficients.begin() + kPlumbBob, coefficients.end(),
                                    [](double coefficient) { return coefficient != 0.0; });
  if (has_more) distortion.failExpecting("the five coefficients of plumb_bob, or rational_polynomial");
  setDistortion(coefficients, distortion, camera.model);
  const StrictYaml rotation = yaml[keys.R];
  camera.R_rectified_camera = rotationFrom(readMatrix(rotation, 9), rotation);
  const StrictYaml projection = yaml[keys.P];
  const Eigen::Vector3d translation =
      setProjectionMatrix(readMatrix(projection, 12), projection, camera.rectified);
  if (translation.y() != 0.0 || translation.z() != 0.0)
    projection.fail("expected a camera beside the other, and 0 in the last column's second and third row");
  camera.centre = -translation.x();
  return camera;
}

/// Throws std::runtime_error unless the projection matrices are those of one rectified pair.
void requireOnePair(const RosCamera& left, const RosCamera& right, const std::filesystem::path& right_file) {
  constexpr double kTolerance = 1e-6;  // relative
  if (std::abs(right.centre - left.centre) < kMinBaseline) {
    throw std::runtime_error(
        right_file.string() + ": projection_matrix (P): Tx, its fourth number, is that of the left camera (" +
        exactText(0.0 - right.rectified.fx * right.centre) +
        "), so that both cameras stand at one place; expected 0 in the left and -fx * baseline in the "
        "right: did the driver leave it out? Write the right number there, or give the files of the stereo "
        "calibration");
  }
  const double f = left.rectified.fx;
  const bool is_pair = std::abs(right.rectified.fx - f) <= kTolerance * f &&
                       std::abs(right.rectified.cy - left.rectified.cy) <= kTolerance * f;
  if (is_pair) return;
  throw std::runtime_error(
      right_file.string() + ": projection_matrix: its focal length (" + exactText(right.rectified.fx) +
      ") and cy (" + exactText(right.rectified.cy) + ") differ from the left camera's (" + exactText(f) +
      ", " + exactText(left.rectified.cy) + "): the two files are not of one stereo calibration");
}

std::string matrixText(const std::string& name, std::size_t rows, const std::vector<double>& values) {
  return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(values.size() / rows) +
         "\n  data: " + exactText(values) + "\n";
}

std::string distortionText(const CameraModel& camera) {
  std::string name = "plumb_bob";
  std::size_t count = kPlumbBob;
  if (camera.lens == LensModel::wide) {
    name = "equidistant";
    count = distortionCount(camera.lens);
  } else if (std::any_of(camera.distortion.begin() + kPlumbBob, camera.distortion.end(),
                         [](double coefficient) { return coefficient != 0.0; })) {
    name = "rational_polynomial";
    count = camera.distortion.size();
  }
  const auto begin = camera.distortion.begin();
  return "distortion_model: " + name + "\n" +
         matrixText("distortion_coefficients", 1, {begin, begin + static_cast<std::ptrdiff_t>(count)});
}

std::string cameraText(const char* name, const CameraModel& camera, const Eigen::Matrix3d& R,
                       const Rectification& rectified, double centre) {
  const double f = rectified.focal_length;
  return "image_width: " + std::to_string(camera.size.width) +
         "\nimage_height: " + std::to_string(camera.size.height) + "\ncamera_name: " + name + "\n" +
         matrixText("camera_matrix", 3, cameraMatrixRows(camera)) + distortionText(camera) +
         matrixText("rectification_matrix", 3, rowsOf(R)) +
         matrixText("projection_matrix", 3,
                    {f, 0.0, rectified.cx, -f * centre, 0.0, f, rectified.cy, 0.0, 0.0, 0.0, 1.0, 0.0});
}

}  // namespace

bool isRosCamera(const StrictYaml& yaml) {
  return yaml.has(keysOf(yaml).K);
}

Rig readRosRig(const std::filesystem::path& left_file, const std::filesystem::path& right_file) {
  const RosCamera left = readCamera(left_file);
  const RosCamera right = readCamera(right_file);
  requireOnePair(left, right, right_file);
  Rig rig;
  rig.name = "ROS";
  rig.left = left.model;
  rig.right = right.model;
  // Rectified axes are common to both cameras; the right camera is shifted by the baseline along x.
  const Eigen::Matrix3d R_right_rectified = right.R_rectified_camera.transpose();
  rig.T_right_left.linear() = R_right_rectified * left.R_rectified_camera;
  rig.T_right_left.translation() = R_right_rectified * Eigen::Vector3d(left.centre - right.centre, 0.0, 0.0);
  return importedRig(rig, right_file);
}

RosText rosText(const Rig& rig) {
  const Rectification rectified = computeRectification(rig, rig.rectification);
  return {cameraText("left", rig.left, rectified.R_rectified_left, rectified, 0.0),
          cameraText("right", rig.right, rectified.R_rectified_right, rectified, rectified.baseline)};
}

}  // namespace cartvo::calib
