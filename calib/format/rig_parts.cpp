// YAML parts that the rig formats of several tools share.
#include "calib/format/rig_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>

#include "calib/format/rig_formats.hpp"
#include "calib/model/rig_validation.hpp"
#include "calib/model/rotation.hpp"
#include "common/exact_text.hpp"
#include "common/input_file.hpp"

namespace cartvo::calib {
namespace {

template <int N>
std::vector<double> rowByRow(const Eigen::Matrix<double, N, N>& matrix) {
  const Eigen::Matrix<double, N, N, Eigen::RowMajor> rows = matrix;
  return {rows.data(), rows.data() + rows.size()};
}

/// The values of OpenCV's FileStorage in XML, as YAML. Throws cv::Exception if the text is no FileStorage.
std::string yamlFromXml(const std::string& xml) {
  const cv::FileStorage storage(xml, cv::FileStorage::READ | cv::FileStorage::MEMORY);
  cv::FileStorage yaml(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const cv::FileNode root = storage.root();
  for (const cv::String& key : root.keys()) {
    const cv::FileNode node = root[key];
    if (node.isMap()) {
      cv::Mat matrix;
      node >> matrix;
      yaml << key << matrix;
    } else if (node.isSeq()) {
      std::vector<double> values;
      node >> values;
      yaml << key << values;
    } else if (node.isInt()) {
      yaml << key << static_cast<int>(node);
    } else if (node.isReal()) {
      yaml << key << static_cast<double>(node);
    } else if (node.isString()) {
      yaml << key << static_cast<std::string>(node);
    }
  }
  return yaml.releaseAndGetString();
}

/// The first one of several messages that 'rostopic echo' printed, which '---' separates: a camera's
/// camera_info is always the same. Other text as it is.
std::string firstMessage(std::string text) {
  const std::size_t end = text.find("\n---");
  const bool is_message = end != std::string::npos && text.find("\ndistortion_model:") < end;
  if (is_message) text.resize(end + 1);
  return text;
}

/// The text as YAML. An error of the parser is that of a rig's YAML only if one of the known keys is there.
StrictYaml parseYaml(const std::string& text, const std::filesystem::path& file) {
  constexpr std::array kKeys{
      "cartvo_rig", "K1", "M1",       "cameraMatrix1", "cam0",          "CameraParameters1",
      "P0",         "P2", "P_rect_0", "T_BS",          "camera_matrix", "distortion_model"};
  try {
    return StrictYaml::parse(text, file);
  } catch (const std::runtime_error& error) {
    const bool is_known = std::any_of(
        kKeys.begin(), kKeys.end(), [&text](const char* key) { return text.find(key) != std::string::npos; });
    if (is_known) throw;
    throw std::runtime_error(file.string() + ": is in none of the known formats: " + kKnownRigFormats +
                             "; read as YAML: " + error.what());
  }
}

}  // namespace

Rig importedRig(Rig rig, const std::filesystem::path& file) {
  rig.T_body_camera = forwardLookingMount();
  try {
    validateRig(rig);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
  return rig;
}

StrictYaml readYamlOrXml(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMaxBytes = 64U << 20U;  // of MATLAB's and other binary files, to name them
  std::string content = withoutByteOrderMark(readInputFile(file, kMaxBytes));
  refuseOtherRigs(content, file);
  const std::string text = firstMessage(std::move(content));
  constexpr std::size_t kMaxText = 1U << 20U;
  if (text.size() > kMaxText)
    throw std::runtime_error(file.string() + ": is larger than 1 MiB; expected " + kKnownRigFormats);
  if (!text.starts_with("<?xml")) return parseYaml(text, file);
  std::string yaml;
  try {
    yaml = yamlFromXml(text);
  } catch (const cv::Exception&) {
    throw std::runtime_error(file.string() + ": is XML, but not a complete FileStorage of OpenCV");
  }
  return StrictYaml::parse(yaml, file);
}

cv::Size readImageSize(const StrictYaml& yaml) {
  const std::vector<double> size = yaml.numbers(2);
  for (const double side : size) {
    if (!(side >= kMinImageSide && side <= kMaxImageSide))
      yaml.failExpecting("two sides of an image from 16 to 8192 px");
  }
  return {static_cast<int>(size[0]), static_cast<int>(size[1])};
}

std::vector<double> readMatrix(const StrictYaml& yaml) {
  if (yaml.isSequence()) return yaml.numbers();
  const auto rows = yaml["rows"].integer(1, 100);
  const auto columns = yaml["cols"].integer(1, 100);
  return yaml["data"].numbers(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
}

std::vector<double> readMatrix(const StrictYaml& yaml, std::size_t count) {
  std::vector<double> values = readMatrix(yaml);
  if (values.size() != count)
    (yaml.isSequence() ? yaml : yaml["data"]).failExpecting(std::to_string(count) + " numbers");
  return values;
}

Eigen::Matrix3d rotationFrom(const std::vector<double>& rows, const StrictYaml& yaml) {
  const Eigen::Matrix3d matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
  if (!isRotation(matrix)) {
    yaml.fail("expected a rotation with orthonormal rows, found " +
              exactText(std::vector<double>(rows.begin(), rows.begin() + 9)));
  }
  return nearestRotation(matrix);
}

Eigen::Isometry3d transformFrom(const std::vector<double>& rows, const StrictYaml& yaml) {
  const Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(rows.data());
  if (T.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0))
    yaml.failExpecting("a 4x4 transform, whose last row is 0 0 0 1");
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = rotationFrom(rowsOf(Eigen::Matrix3d(T.topLeftCorner<3, 3>())), yaml);
  transform.translation() = T.topRightCorner<3, 1>();
  return transform;
}

void setCameraMatrix(const std::vector<double>& K, const StrictYaml& yaml, CameraModel& camera) {
  constexpr double kNoSkew = 1e-9;  // relative to fx: rounding
  if (K[2] == 0.0 && K[5] == 0.0 && (K[6] != 0.0 || K[7] != 0.0)) {
    yaml.fail("is transposed: the principal point (" + exactText(K[6]) + ", " + exactText(K[7]) +
              ") is in the last row, and belongs into the last column; exchange rows and columns");
  }
  if (std::abs(K[1]) > kNoSkew * std::abs(K[0])) {
    yaml.fail("has a skew of " + exactText(K[1]) +
              " px, which this camera model does not have: calibrate with the skew fixed at 0 "
              "(cv::fisheye::CALIB_FIX_SKEW; in MATLAB EstimateSkew false)");
  }
  if (K[3] != 0.0 || K[6] != 0.0 || K[7] != 0.0 || K[8] != 1.0)
    yaml.fail("expected [fx 0 cx; 0 fy cy; 0 0 1], found " + exactText(K));
  camera.fx = K[0];
  camera.fy = K[4];
  camera.cx = K[2];
  camera.cy = K[5];
}

Eigen::Vector3d setProjectionMatrix(const std::vector<double>& P, const StrictYaml& yaml,
                                    CameraModel& camera) {
  constexpr double kTolerance = 1e-9;  // relative
  const bool is_rectified = P[0] > 0.0 && std::abs(P[0] - P[5]) <= kTolerance * P[0] && P[1] == 0.0 &&
                            P[4] == 0.0 && P[8] == 0.0 && P[9] == 0.0 && P[10] == 1.0;
  if (!is_rectified)
    yaml.fail("expected the rows of [f 0 cx -f*b; 0 f cy 0; 0 0 1 0], found " + exactText(P));
  camera.fx = P[0];
  camera.fy = P[5];
  camera.cx = P[2];
  camera.cy = P[6];
  return {(P[3] - P[2] * P[11]) / P[0], (P[7] - P[6] * P[11]) / P[5], P[11]};
}

void readIntrinsics(const StrictYaml& yaml, CameraModel& camera) {
  const std::vector<double> intrinsics = yaml.numbers(4);
  camera.fx = intrinsics[0];
  camera.fy = intrinsics[1];
  camera.cx = intrinsics[2];
  camera.cy = intrinsics[3];
}

void setDistortion(const std::vector<double>& coefficients, const StrictYaml& yaml, CameraModel& camera) {
  const std::size_t used = std::min(coefficients.size(), distortionCount(camera.lens));
  std::copy_n(coefficients.begin(), used, camera.distortion.begin());
  const auto beyond = coefficients.begin() + static_cast<std::ptrdiff_t>(used);
  const auto extra = std::find_if(beyond, coefficients.end(), [](double value) { return value != 0.0; });
  if (extra == coefficients.end()) return;
  const auto index = static_cast<std::size_t>(extra - coefficients.begin());
  const std::string found = "; coefficient " + std::to_string(index + 1) + " is " + exactText(*extra);
  yaml.fail(
      camera.lens == LensModel::wide
          ? "expected 4 coefficients (k1 k2 k3 k4)" + found
          : "expected at most 8 coefficients (k1 k2 p1 p2 k3 k4 k5 k6)" + found +
                ": thin-prism (s1 to s4) and tilt (tx ty) ones are not supported; calibrate without them");
}

std::vector<double> firstCoefficients(const CameraModel& camera, std::size_t count, const char* format) {
  const auto begin = camera.distortion.begin(), end = begin + static_cast<std::ptrdiff_t>(count);
  if (std::any_of(end, camera.distortion.end(), [](double coefficient) { return coefficient != 0.0; })) {
    throw std::invalid_argument(std::string(format) + " holds the first " + std::to_string(count) +
                                " of the distortion coefficients k1 k2 p1 p2 k3 k4 k5 k6; this rig has more");
  }
  return {begin, end};
}

std::vector<double> rowsOf(const Eigen::Matrix3d& matrix) {
  return rowByRow(matrix);
}

std::vector<double> rowsOf(const Eigen::Matrix4d& matrix) {
  return rowByRow(matrix);
}

std::vector<double> cameraMatrixRows(const CameraModel& camera) {
  return {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0};
}

}  // namespace cartvo::calib
