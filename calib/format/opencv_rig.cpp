// Readers and writers for OpenCV's FileStorage and MATLAB's stereoParameters.
#include "calib/format/opencv_rig.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <stdexcept>
#include <vector>

#include "calib/format/rig_parts.hpp"
#include "calib/model/rig_validation.hpp"
#include "common/ascii_text.hpp"
#include "common/exact_text.hpp"
#include "common/image_size.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

// Names of the same matrix in files of different programs, without the number of the camera.
constexpr std::array kCameraMatrixKeys{"K", "M", "cameraMatrix"};
constexpr std::array kDistortionKeys{"D", "distCoeffs"};

/// The values of several files as of one.
class OpenCvFiles {
 public:
  explicit OpenCvFiles(const std::vector<StrictYaml>& files) : files_(files) {}

  /// The value of a key in the first file that has it; nothing if none has.
  std::optional<StrictYaml> find(const std::string& key) const {
    for (const StrictYaml& file : files_) {
      if (file.has(key)) return file[key];
    }
    return std::nullopt;
  }

  /// The value of the first of `keys` that exists; nothing if none does.
  std::optional<StrictYaml> findAny(std::initializer_list<const char*> keys) const {
    for (const char* const key : keys) {
      if (auto value = find(key)) return value;
    }
    return std::nullopt;
  }

  /// The value of the first of `names` with `number` behind it that exists; nothing if none does.
  template <typename Names>
  std::optional<StrictYaml> findNumbered(const Names& names, const std::string& number) const {
    for (const char* const name : names) {
      if (auto value = find(name + number)) return value;
    }
    return std::nullopt;
  }

  /// As findNumbered. Throws if none exists.
  template <typename Names>
  StrictYaml require(const Names& names, const std::string& number) const {
    if (const auto value = findNumbered(names, number)) return *value;
    return files_.back()[names.front() + number];  // throws
  }

 private:
  const std::vector<StrictYaml>& files_;
};

bool containsAny(std::string text, std::initializer_list<const char*> words) {
  text = lowerCase(text);
  return std::any_of(words.begin(), words.end(),
                     [&text](const char* word) { return text.find(word) != std::string::npos; });
}

/// The lens model that the files name; nothing if they name none. Throws for a model that is not read.
std::optional<LensModel> namedLens(const OpenCvFiles& files) {
  if (const auto xi = files.findAny({"xi", "xi1", "xi2"}))
    xi->fail(
        "belongs to an omnidirectional lens (cv::omnidir), which is not read; calibrate with cv::fisheye");
  if (const auto flag = files.find("fisheye_model"))
    return flag->integer(0, 1) == 1 ? LensModel::wide : LensModel::brown;
  // Kalibr's "pinhole" may have equidistant distortion: the distortion's name is read first.
  const auto name = files.findAny({"distortion_model", "lens_model", "camera_model", "model_type", "model"});
  if (!name || !name->isText()) return std::nullopt;
  if (containsAny(name->text(), {"fisheye", "equidistant", "kannala", "kb4"})) return LensModel::wide;
  if (containsAny(name->text(), {"pinhole", "brown", "radtan", "radial", "plumb", "rational", "opencv"}))
    return LensModel::brown;
  // These keys may name a product, too.
  const bool is_lens = files.findAny({"distortion_model", "lens_model"}) ||
                       containsAny(name->text(), {"omni", "mei", "double", "eucm", "unified", "scaramuzza"});
  if (!is_lens) return std::nullopt;
  name->failExpecting("a pinhole with Brown's distortion (brown), or cv::fisheye's (fisheye)");
}

/// Whether four coefficients can only be Brown's k1 k2 p1 p2, not k1 k2 k3 k4 of cv::fisheye: all are zero,
/// or k1 is below that of an orthographic lens (sin(theta) = theta - theta^3 / 6 + ...), which has the
/// strongest distortion of all fisheye lenses, and p1 and p2 are those of a lens that is hardly tilted.
bool isBrown(const std::vector<double>& D) {
  constexpr double kOrthographic = -1.0 / 6.0, kMaxTangential = 0.01;
  const bool is_zero = std::all_of(D.begin(), D.end(), [](double value) { return value == 0.0; });
  return is_zero ||
         (D[0] < kOrthographic && std::abs(D[2]) <= kMaxTangential && std::abs(D[3]) <= kMaxTangential);
}

/// The lens model of both cameras: as the files name it; else Brown's unless there are four coefficients,
/// then by the file's name and the numbers. Throws std::runtime_error that asks for it where nothing tells.
LensModel lensOf(const OpenCvFiles& files, const std::filesystem::path& name) {
  constexpr std::size_t kAmbiguous = 4;
  if (const auto lens = namedLens(files)) return *lens;
  std::optional<StrictYaml> asked;
  for (const char* const number : {"1", "2"}) {
    const std::optional<StrictYaml> yaml = files.findNumbered(kDistortionKeys, number);
    if (!yaml) continue;
    const std::vector<double> D = readMatrix(*yaml);
    if (D.size() != kAmbiguous) return LensModel::brown;
    if (!isBrown(D) && !asked) asked = yaml;
  }
  if (!asked) return LensModel::brown;
  if (containsAny(name.filename().string(), {"fisheye", "kannala"})) return LensModel::wide;
  asked->fail(
      "has four coefficients " + exactText(readMatrix(*asked)) +
      ", which may be k1 k2 p1 p2 of Brown's model or k1 k2 k3 k4 of cv::fisheye: add to the file the key "
      "fisheye_model with the value 0 (Brown) or 1 (cv::fisheye), in YAML the line 'fisheye_model: 1'");
}

CameraModel readCamera(const OpenCvFiles& files, const std::string& number, cv::Size size, LensModel lens) {
  CameraModel camera;
  camera.size = size;
  camera.lens = lens;
  const StrictYaml matrix = files.require(kCameraMatrixKeys, number);
  setCameraMatrix(readMatrix(matrix, 9), matrix, camera);
  const StrictYaml distortion = files.require(kDistortionKeys, number);
  setDistortion(readMatrix(distortion), distortion, camera);
  return camera;
}

/// The images' size in the files, else the given one. Throws if both exist and differ, or none exists.
cv::Size readSize(const OpenCvFiles& files, std::optional<cv::Size> given) {
  const std::optional<StrictYaml> one = files.findAny({"image_size", "imageSize"});
  const std::optional<StrictYaml> width = files.find("image_width"), height = files.find("image_height");
  std::optional<cv::Size> size;
  if (one) {
    size = readImageSize(*one);
  } else if (width && height) {
    size = cv::Size(static_cast<int>(width->integer(kMinImageSide, kMaxImageSide)),
                    static_cast<int>(height->integer(kMinImageSide, kMaxImageSide)));
  }
  if (size && given && *size != *given)
    (one ? *one : *width)
        .fail("the file is for images of " + sizeText(*size) + ", not of " + sizeText(*given));
  return size ? *size : given.value_or(cv::Size());
}

/// Throws unless the baseline in P2 (-P2[0][3] / P2[0][0], cv::stereoRectify) is the length of T.
void checkProjection(const OpenCvFiles& files, double baseline) {
  constexpr double kTolerance = 0.01;  // relative
  const std::optional<StrictYaml> yaml = files.find("P2");
  if (!yaml) return;
  const std::vector<double> P = readMatrix(*yaml, 12);
  const double projected = P[0] != 0.0 ? std::abs(P[3] / P[0]) : 0.0;
  if (std::abs(projected - baseline) <= kTolerance * baseline) return;
  yaml->fail("gives a baseline of " + exactText(projected) + " m, and T one of " + exactText(baseline) +
             " m: they are not of one calibration");
}

std::string matrixText(const std::string& name, std::size_t columns, const std::vector<double>& values) {
  return name + ": !!opencv-matrix\n   rows: " + std::to_string(values.size() / columns) +
         "\n   cols: " + std::to_string(columns) + "\n   dt: d\n   data: " + exactText(values) + "\n";
}

std::string cameraText(const std::string& number, const CameraModel& camera) {
  const std::vector<double> D =
      firstCoefficients(camera, distortionCount(camera.lens), "an OpenCV FileStorage");
  // cv::fisheye accepts only a column, cv::stereoRectify a row or a column.
  return matrixText("K" + number, 3, cameraMatrixRows(camera)) + matrixText("D" + number, 1, D);
}

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

std::string matlabCameraText(const char* name, const CameraModel& camera) {
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

bool isOpenCvRig(const StrictYaml& yaml) {
  const auto has_any = [&yaml](const auto& names) {
    return std::any_of(names.begin(), names.end(),
                       [&yaml](const char* name) { return yaml.has(std::string(name) + "1"); });
  };
  return has_any(kCameraMatrixKeys) || (yaml.has("R") && yaml.has("T"));
}

Rig parseOpenCvRig(const std::vector<StrictYaml>& yaml_files, const std::filesystem::path& name,
                   std::optional<cv::Size> image_size) {
  const OpenCvFiles files(yaml_files);
  const cv::Size size = readSize(files, image_size);
  const LensModel lens = lensOf(files, name);
  Rig rig;
  rig.name = name.stem().string();
  rig.left = readCamera(files, "1", size, lens);
  rig.right = readCamera(files, "2", size, lens);
  const auto required = [&](const char* key) {
    const std::optional<StrictYaml> value = files.find(key);
    if (value) return *value;
    throw std::runtime_error(name.string() + ": " + key +
                             " is missing; if it is in another file (OpenCV's sample stereo_calib writes "
                             "intrinsics.yml and extrinsics.yml), give both to 'cartvo calibrate convert'");
  };
  const StrictYaml R = required("R"), T = required("T");
  rig.T_right_left.linear() = rotationFrom(readMatrix(R, 9), R);
  const std::vector<double> t = readMatrix(T, 3);
  rig.T_right_left.translation() = Eigen::Vector3d(t[0], t[1], t[2]);
  checkProjection(files, rig.baseline());
  if (size.empty()) {
    throw std::runtime_error(
        name.string() + ": image_size is missing; give --size WIDTHxHEIGHT to 'cartvo calibrate convert'");
  }
  return importedRig(rig, name);
}

std::string openCvText(const Rig& rig) {
  if (rig.left.lens != rig.right.lens)
    throw std::invalid_argument("an OpenCV FileStorage holds one lens model; this rig has two");
  const Eigen::Vector3d& t = rig.T_right_left.translation();
  return "%YAML:1.0\n---\nimage_size: [" + std::to_string(rig.left.size.width) + ", " +
         std::to_string(rig.left.size.height) +
         "]\nfisheye_model: " + (rig.left.lens == LensModel::wide ? "1" : "0") + "\n" +
         cameraText("1", rig.left) + cameraText("2", rig.right) +
         matrixText("R", 3, rowsOf(Eigen::Matrix3d(rig.T_right_left.linear()))) +
         matrixText("T", 1, {t.x(), t.y(), t.z()});
}

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
  return "{\n" + matlabCameraText("CameraParameters1", rig.left) +
         matlabCameraText("CameraParameters2", rig.right) + "  \"RotationOfCamera2\": " +
         rowsText(rowsOf(Eigen::Matrix3d(rig.T_right_left.linear().transpose()))) +
         ",\n  \"TranslationOfCamera2\": " + exactText({t.x(), t.y(), t.z()}) + "\n}\n";
}

}  // namespace cartvo::calib
