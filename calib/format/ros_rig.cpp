// Readers and writers for ROS camera_info files of a stereo pair and KITTI's calibration files.
#include "calib/format/ros_rig.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "calib/format/rig_parts.hpp"
#include "calib/model/rig_validation.hpp"
#include "calib/rectification/rectification.hpp"
#include "common/exact_text.hpp"
#include "common/image_size.hpp"
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

/// The numbers behind a key, separated by blanks.
std::vector<double> readNumbers(const StrictYaml& yaml, std::size_t count, const char* meaning) {
  const std::string text = yaml.text();
  const char* position = text.data();
  const char* const end = text.data() + text.size();
  const auto skip_blanks = [&] {
    position = std::find_if(position, end, [](char c) { return c != ' ' && c != '\t'; });
  };
  std::vector<double> values;
  for (skip_blanks(); position != end && values.size() <= count; skip_blanks()) {
    if (*position == '+' && position + 1 != end && position[1] != '-') ++position;
    double value = 0.0;
    const auto [behind, error] = std::from_chars(position, end, value);
    const bool is_whole = behind == end || *behind == ' ' || *behind == '\t';
    if (error != std::errc() || !is_whole || !std::isfinite(value)) break;
    values.push_back(value);
    position = behind;
  }
  if (values.size() != count || position != end)
    yaml.failExpecting(std::to_string(count) + " numbers, " + meaning);
  return values;
}

cv::Size readSize(const StrictYaml& yaml) {
  const std::vector<double> size = readNumbers(yaml, 2, "the width and height of an image");
  for (const double side : size) {
    if (side < kMinImageSide || side > kMaxImageSide) yaml.failExpecting("an image's sides, 16 to 8192 px");
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

/// The rig of rectified cameras with the projection matrices under these keys.
Rig rectifiedRig(const StrictYaml& yaml, const std::array<std::string, 2>& keys, cv::Size size) {
  constexpr const char* kMeaning = "the rows of [f 0 cx -f*b; 0 f cy 0; 0 0 1 0]";
  const auto camera_of = [&](const std::string& key, CameraModel& camera) {
    camera.size = size;
    return setProjectionMatrix(readNumbers(yaml[key], 12, kMeaning), yaml[key], camera);
  };
  Rig rig;
  const Eigen::Vector3d left = camera_of(keys[0], rig.left), right = camera_of(keys[1], rig.right);
  rig.T_right_left.translation() = right - left;
  return rig;
}

/// A raw camera and the transform from camera 0.
Eigen::Isometry3d readRawCamera(const StrictYaml& yaml, const std::string& number, CameraModel& camera) {
  constexpr std::size_t kCoefficients = 5;
  camera.size = readSize(yaml["S_" + number]);
  setCameraMatrix(readNumbers(yaml["K_" + number], 9, "a camera matrix"), yaml["K_" + number], camera);
  setDistortion(readNumbers(yaml["D_" + number], kCoefficients, "k1 k2 p1 p2 k3"), yaml["D_" + number],
                camera);
  Eigen::Isometry3d T_camera_first = Eigen::Isometry3d::Identity();
  T_camera_first.linear() =
      rotationFrom(readNumbers(yaml["R_" + number], 9, "a rotation"), yaml["R_" + number]);
  const std::vector<double> t = readNumbers(yaml["T_" + number], 3, "a translation in metres");
  T_camera_first.translation() = Eigen::Vector3d(t[0], t[1], t[2]);
  return T_camera_first;
}

/// The rig of a raw recording whose images have the given size.
Rig recordedRig(const StrictYaml& yaml, std::array<std::string, 2> numbers,
                std::optional<cv::Size> image_size) {
  const cv::Size raw = readSize(yaml["S_" + numbers[0]]), rectified = readSize(yaml["S_rect_" + numbers[0]]);
  if (!image_size || (*image_size != raw && *image_size != rectified)) {
    yaml.fail(std::string("KITTI's calib_cam_to_cam.txt describes the raw images (") + sizeText(raw) +
              ") and the rectified ones (" + sizeText(rectified) + "): " +
              (image_size ? "yours are " + sizeText(*image_size) + ", which is neither"
                          : "give the size of yours by --size"));
  }
  if (*image_size == rectified)
    return rectifiedRig(yaml, {"P_rect_" + numbers[0], "P_rect_" + numbers[1]}, rectified);
  Rig rig;
  const Eigen::Isometry3d T_left_first = readRawCamera(yaml, numbers[0], rig.left);
  const Eigen::Isometry3d T_right_first = readRawCamera(yaml, numbers[1], rig.right);
  rig.T_right_left = T_right_first * T_left_first.inverse();
  return rig;
}

std::string projectionRow(const char* name, const CameraModel& camera, double tx) {
  std::string row = name;
  for (const double value :
       {camera.fx, 0.0, camera.cx, tx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0})
    row.append(1, ' ').append(exactText(value));
  return row + "\n";
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

bool isKittiRig(const StrictYaml& yaml) {
  return yaml.has("P0") || yaml.has("P2") || yaml.has("P_rect_00") || yaml.has("P_rect_02");
}

Rig parseKittiRig(const StrictYaml& yaml, const std::filesystem::path& name,
                  std::optional<cv::Size> image_size, std::array<int, 2> cameras) {
  const std::string left = std::to_string(cameras[0]), right = std::to_string(cameras[1]);
  Rig rig;
  if (yaml.has("P_rect_0" + left)) {
    rig = recordedRig(yaml, {"0" + left, "0" + right}, image_size);
  } else {
    if (!image_size)
      throw std::runtime_error(name.string() +
                               ": KITTI's calib.txt does not contain the image size: give it by --size");
    rig = rectifiedRig(yaml, {"P" + left, "P" + right}, *image_size);
  }
  rig.name = "KITTI";
  return importedRig(rig, name);
}

bool isKittiRig(const Rig& rig) {
  const Eigen::Vector3d t = rig.T_right_left.translation();
  return isPinhole(rig.left) && isPinhole(rig.right) && rig.left.fx == rig.left.fy &&
         rig.right.fx == rig.right.fy && rig.left.fx == rig.right.fx &&
         rig.T_right_left.linear().isIdentity(1e-12) && t.y() == 0.0 && t.z() == 0.0;
}

std::string kittiText(const Rig& rig) {
  if (!isKittiRig(rig)) {
    throw std::invalid_argument(
        "KITTI's calib.txt describes rectified images (no distortion, parallel axes, one focal length); "
        "this rig's are raw");
  }
  return projectionRow("P0:", rig.left, 0.0) +
         projectionRow("P1:", rig.right, rig.right.fx * rig.T_right_left.translation().x());
}

}  // namespace cartvo::calib
