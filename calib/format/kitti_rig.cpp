// Reader and writer for the calib.txt of KITTI odometry sequences.
#include "calib/format/kitti_rig.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "calib/format/rig_parts.hpp"
#include "calib/model/rig_validation.hpp"
#include "common/exact_text.hpp"
#include "common/image_size.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

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
