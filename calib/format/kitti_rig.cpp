// Reader and writer for the calib.txt of KITTI odometry sequences.
#include "calib/format/kitti_rig.hpp"

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "calib/format/rig_parts.hpp"
#include "common/exact_text.hpp"

namespace cartvo::calib {
namespace {

using ProjectionMatrix = std::vector<double>;  ///< 3x4, row by row

std::map<std::string, ProjectionMatrix> readProjections(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read; does the file exist?");
  std::map<std::string, ProjectionMatrix> projections;
  std::string line;
  for (int number = 1; std::getline(stream, line) && number <= 100; ++number) {
    if (!line.starts_with("P0:") && !line.starts_with("P1:")) continue;
    std::istringstream values(line.substr(3));
    ProjectionMatrix P;
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

std::string projectionRow(const char* name, const CameraModel& camera, double tx) {
  std::string row = name;
  for (const double value :
       {camera.fx, 0.0, camera.cx, tx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0})
    row.append(1, ' ').append(exactText(value));
  return row + "\n";
}

}  // namespace

Rig readKittiRig(const std::filesystem::path& calibration, cv::Size image_size) {
  const auto projections = readProjections(calibration);
  if (!projections.contains("P0") || !projections.contains("P1")) {
    throw std::runtime_error(calibration.string() +
                             ": expected the lines 'P0: ...' and 'P1: ...' of a KITTI calib.txt");
  }
  const auto camera_from = [&](const ProjectionMatrix& P) {
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
  return importedRig(rig, calibration);
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
