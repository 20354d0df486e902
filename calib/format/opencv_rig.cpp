// Reader and writer for stereo calibrations in OpenCV's FileStorage format.
#include "calib/format/opencv_rig.hpp"

#include <vector>

#include "calib/format/rig_parts.hpp"
#include "common/exact_text.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {
namespace {

CameraModel readCamera(const StrictYaml& yaml, const std::string& number, cv::Size size, LensModel lens) {
  const std::vector<double> K = readMatrix(yaml["K" + number], 9);
  CameraModel camera;
  camera.size = size;
  camera.lens = lens;
  camera.fx = K[0];
  camera.fy = K[4];
  camera.cx = K[2];
  camera.cy = K[5];
  setDistortion(readMatrix(yaml["D" + number]), yaml["D" + number], camera);
  return camera;
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

}  // namespace

Rig parseOpenCvRig(const StrictYaml& yaml, const std::filesystem::path& name) {
  const cv::Size size = readImageSize(yaml["image_size"]);
  const bool is_wide = yaml.has("fisheye_model") && yaml["fisheye_model"].integer(0, 1) == 1;
  const LensModel lens = is_wide ? LensModel::wide : LensModel::brown;
  Rig rig;
  rig.name = name.stem().string();
  rig.left = readCamera(yaml, "1", size, lens);
  rig.right = readCamera(yaml, "2", size, lens);
  rig.T_right_left.linear() = rotationFrom(readMatrix(yaml["R"], 9), yaml["R"]);
  const std::vector<double> T = readMatrix(yaml["T"], 3);
  rig.T_right_left.translation() = Eigen::Vector3d(T[0], T[1], T[2]);
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

}  // namespace cartvo::calib
