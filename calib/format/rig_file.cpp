// Reader and writer of rig files.
#include "calib/format/rig_file.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/format/kalibr_rig.hpp"
#include "calib/format/mask_key.hpp"
#include "calib/format/opencv_rig.hpp"
#include "calib/format/rig_parts.hpp"
#include "calib/model/rig_validation.hpp"
#include "calib/model/rotation.hpp"
#include "common/atomic_file.hpp"
#include "common/exact_text.hpp"
#include "common/input_file.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

using Folder = std::optional<std::filesystem::path>;

constexpr int kFormatVersion = 1;

LensModel readLens(const StrictYaml& yaml) {
  const std::string name = yaml.text();
  if (name == "wide") return LensModel::wide;
  if (name != "brown") yaml.failExpecting("brown or wide");
  return LensModel::brown;
}

bool readFlag(const StrictYaml& yaml) {
  const std::string flag = yaml.text();
  if (flag != "true" && flag != "false") yaml.failExpecting("true or false");
  return flag == "true";
}

CameraModel readCamera(const StrictYaml& yaml, cv::Size size, const Folder& folder) {
  yaml.allowOnly({"fx", "fy", "cx", "cy", "lens", "distortion", "readout", "mask"});
  CameraModel camera;
  camera.size = size;
  camera.fx = yaml["fx"].number(kMinFocalLength, kMaxFocalLength);
  camera.fy = yaml["fy"].number(kMinFocalLength, kMaxFocalLength);
  camera.cx = yaml["cx"].number(minCentre(size.width), maxCentre(size.width));
  camera.cy = yaml["cy"].number(minCentre(size.height), maxCentre(size.height));
  if (yaml.has("lens")) camera.lens = readLens(yaml["lens"]);
  const std::vector<double> distortion = yaml["distortion"].numbers(distortionCount(camera.lens));
  std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
  if (yaml.has("readout")) camera.readout = yaml["readout"].number(-kMaxReadout, kMaxReadout);
  if (yaml.has("mask")) camera.mask = readMask(yaml["mask"], size, folder);
  return camera;
}

Eigen::Isometry3d readTransform(const StrictYaml& yaml) {
  yaml.allowOnly({"rotation", "translation"});
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  const std::vector<double> rotation = yaml["rotation"].numbers(9);
  const Eigen::Matrix3d matrix =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
  if (!isRotation(matrix))
    yaml["rotation"].failExpecting("three orthonormal rows of a right-handed rotation");
  transform.linear() = nearestRotation(matrix);
  const std::vector<double> translation = yaml["translation"].numbers(3);
  transform.translation() = Eigen::Vector3d(translation[0], translation[1], translation[2]);
  return transform;
}

/// Throws std::runtime_error for a rig whose geometry is unusual and not confirmed.
Rig requireUsual(Rig rig, const std::filesystem::path& name, const char* advice) {
  const std::string finding = rig.unusual_geometry ? "" : unusualGeometry(rig);
  if (finding.empty()) return rig;
  throw std::runtime_error(name.string() + ": " + finding + " If the rig is really so, " + advice);
}

Rig parseAnyRig(const StrictYaml& yaml, const std::filesystem::path& name, const Folder& folder) {
  if (yaml.has("cartvo_rig"))
    return requireUsual(parseCartvoRig(yaml, folder), name,
                        "add the line 'unusual_geometry: true' to the file");
  if (const std::optional<Rig> rig = parseForeignRig(yaml, name, {}))
    return requireUsual(*rig, name,
                        "'cartvo calibrate convert --unusual-geometry' makes a rig.yaml that says so");
  throw std::runtime_error(
      name.string() +
      ": is neither a cartvo rig file (key cartvo_rig) nor an OpenCV FileStorage with K1 D1 K2 D2 R T "
      "image_size, a Kalibr camchain (cam0) or MATLAB's stereoParameters as JSON (CameraParameters1); files "
      "of other tools are read by 'cartvo calibrate convert'");
}

std::string cameraText(const CameraModel& camera, const Folder& folder) {
  const std::string lens = camera.lens == LensModel::wide ? "\n  lens: wide" : "";
  const std::string readout =
      camera.readout ? "  readout: " + exactText(*camera.readout) +
                           "  # s, exposure of the raw image's lower edge minus that of its upper edge\n"
                     : "";
  const std::string mask =
      camera.mask.empty()
          ? ""
          : "  # Parts of the raw image that never show the scene, and are not used.\n  mask: " +
                maskText(camera.mask, folder) + "\n";
  const auto coefficients = camera.distortion.begin();
  const auto count = static_cast<std::ptrdiff_t>(distortionCount(camera.lens));
  return "  fx: " + exactText(camera.fx) + "\n  fy: " + exactText(camera.fy) +
         "\n  cx: " + exactText(camera.cx) + "\n  cy: " + exactText(camera.cy) + lens +
         "\n  distortion: " + exactText(std::vector<double>{coefficients, coefficients + count}) + "\n" +
         readout + mask;
}

std::string transformText(const Eigen::Isometry3d& transform) {
  std::string text = "  rotation:\n";
  for (int row = 0; row < 3; ++row) {
    const Eigen::Vector3d values = transform.linear().row(row);
    text += "    - " + exactText(std::vector<double>{values.x(), values.y(), values.z()}) + "\n";
  }
  const Eigen::Vector3d translation = transform.translation();
  return text + "  translation: " +
         exactText(std::vector<double>{translation.x(), translation.y(), translation.z()}) + "\n";
}

/// T_body_camera, or a comment with its form if it is the default, which is not measured.
std::string mountText(const Rig& rig) {
  if (rig.T_body_camera.matrix() == forwardLookingMount().matrix()) {
    return "# T_body_camera, how the cameras sit on the cart, is not known: velocities are the left "
           "camera's. "
           "'cartvo\n"
           "# calibrate mount' measures and writes it. It takes a point from the left camera's axes to the "
           "cart's (x forward,\n"
           "# y left, z up; m; origin on the ground below the rear axle). For a camera that looks forward:\n"
           "# T_body_camera:\n"
           "#   rotation:\n"
           "#     - [0, 0, 1]\n"
           "#     - [-1, 0, 0]\n"
           "#     - [0, -1, 0]\n"
           "#   translation: [FORWARD, LEFT, HEIGHT]\n";
  }
  return "# Takes a point from the left camera's axes to the cart's (x forward, y left, z up; m; origin on "
         "the\n"
         "# ground below the rear axle). The rotation's columns are the camera's right, down and forward; "
         "the\n"
         "# translation is where the left camera sits.\n"
         "T_body_camera:\n" +
         transformText(rig.T_body_camera);
}

std::string textOf(const Rig& rig, const Folder& folder) {
  return "# A stereo rig: what the two cameras are, how they stand to each other, how they sit on the cart.\n"
         "cartvo_rig: " +
         std::to_string(kFormatVersion) +
         "  # version of this format\n"
         "name: " +
         quotedYaml(rig.name) +
         "\n"
         "# Width and height of the raw images that this calibration holds for, px. Other sizes are "
         "refused.\n"
         "image_size: [" +
         std::to_string(rig.left.size.width) + ", " + std::to_string(rig.left.size.height) +
         "]\n"
         "# Focal lengths and principal point in px, pixel centres at integers; distortion k1 k2 p1 p2 k3 k4 "
         "k5 k6 of\n"
         "# Brown's model or, with 'lens: wide', k1 k2 k3 k4 of Kannala and Brandt's, both as in OpenCV.\n"
         "left:\n" +
         cameraText(rig.left, folder) + "right:\n" + cameraText(rig.right, folder) +
         "# Takes a point from the left camera's axes to the right's (x right, y down, z forward; m), row by "
         "row.\n"
         "# Side by side, the translation is about [-baseline, 0, 0].\n"
         "T_right_left:\n" +
         transformText(rig.T_right_left) + mountText(rig) +
         "# How much of the raw images the rectified ones keep: 0 crops until each pixel has a source, 1 "
         "keeps "
         "all.\n"
         "free_scaling: " +
         exactText(rig.rectification.free_scaling) +
         "\n# Standard deviation of the scale, as a share: all lengths may be too long or too short "
         "together, as "
         "the\n# baseline is. 0: not known, counts as exact.\nscale_deviation: " +
         exactText(rig.scale_stddev) + "\n" +
         (rig.unusual_geometry
              ? "# Confirms numbers above that are unusual for a stereo pair on a vehicle, and "
                "are refused without this line.\nunusual_geometry: true\n"
              : "");
}

}  // namespace

Rig parseCartvoRig(const StrictYaml& yaml, const Folder& folder) {
  yaml.allowOnly({"cartvo_rig", "name", "image_size", "left", "right", "T_right_left", "T_body_camera",
                  "free_scaling", "scale_deviation", "unusual_geometry"});
  yaml["cartvo_rig"].integer(kFormatVersion, kFormatVersion);
  const std::vector<double> size = yaml["image_size"].numbers(2);
  for (const double side : size) {
    if (side < kMinImageSide || side > kMaxImageSide || side != std::floor(side)) {
      yaml["image_size"].failExpecting("[width, height], two integers from 16 to 8192");
    }
  }
  const cv::Size image_size(static_cast<int>(size[0]), static_cast<int>(size[1]));
  Rig rig;
  rig.name = yaml["name"].text();
  rig.left = readCamera(yaml["left"], image_size, folder);
  rig.right = readCamera(yaml["right"], image_size, folder);
  rig.T_right_left = readTransform(yaml["T_right_left"]);
  if (rig.baseline() < kMinBaseline || rig.baseline() > kMaxBaseline) {
    yaml["T_right_left"]["translation"].failExpecting("a baseline of 0.005 m to 10 m");
  }
  rig.T_body_camera =
      yaml.has("T_body_camera") ? readTransform(yaml["T_body_camera"]) : forwardLookingMount();
  if (yaml.has("free_scaling")) rig.rectification.free_scaling = yaml["free_scaling"].number(0.0, 1.0);
  if (yaml.has("scale_deviation")) rig.scale_stddev = yaml["scale_deviation"].number(0.0, kMaxScaleStddev);
  if (yaml.has("unusual_geometry")) rig.unusual_geometry = readFlag(yaml["unusual_geometry"]);
  return rig;
}

std::optional<Rig> parseForeignRig(const StrictYaml& yaml, const std::filesystem::path& name,
                                   std::optional<cv::Size> image_size) {
  if (isOpenCvRig(yaml)) return parseOpenCvRig({yaml}, name, image_size);
  if (yaml.has("cam0")) return parseKalibrRig(yaml, name);
  if (yaml.has("CameraParameters1")) return parseMatlabRig(yaml, name);
  return std::nullopt;
}

Rig readRig(const std::filesystem::path& file) {
  return parseAnyRig(readYamlOrXml(file), file, file.parent_path());
}

Rig parseRig(const std::string& text, const std::filesystem::path& name) {
  return parseAnyRig(StrictYaml::parse(text, name), name, std::nullopt);
}

std::string rigText(const Rig& rig) {
  return textOf(rig, std::nullopt);
}

std::string portableRigText(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMaxBytes = 1U << 20U;
  const Rig rig = readRig(file);
  if (rig.left.mask.file.empty() && rig.right.mask.file.empty()) return readInputText(file, kMaxBytes);
  return rigText(rig);
}

void writeRig(const std::filesystem::path& file, const Rig& rig) {
  validateRig(rig);
  writeResultFile(file, textOf(rig, file.parent_path()));
}

}  // namespace cartvo::calib
