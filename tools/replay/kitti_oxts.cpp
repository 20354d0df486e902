// Reads the ground truth of KITTI's raw recordings.
#include "tools/replay/kitti_oxts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "capture/dataset/dates_and_times.hpp"
#include "common/input_file.hpp"
#include "common/strict_yaml.hpp"
#include "common/units.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxPacketBytes = 1U << 16U;

/// All numbers of a text; empty if it has other words, too.
std::vector<double> numbersOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double number = 0.0; stream >> number;)
    numbers.push_back(number);
  const bool are_numbers =
      stream.eof() && std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); });
  return are_numbers ? numbers : std::vector<double>{};
}

std::vector<double> numbersOf(const StrictYaml& value, std::size_t count) {
  std::vector<double> numbers = numbersOf(value.text());
  if (numbers.size() != count) value.failExpecting(std::to_string(count) + " numbers");
  return numbers;
}

Eigen::Matrix3d rotationOf(const StrictYaml& value) {
  const std::vector<double> rows = numbersOf(value, 9);
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
  constexpr double kTolerance = 1e-3;
  if (!(R * R.transpose()).isIdentity(kTolerance) || R.determinant() < 0.0)
    value.failExpecting("the rows of a rotation");
  return Eigen::Quaterniond(R).normalized().toRotationMatrix();
}

Eigen::Isometry3d transformOf(const fs::path& file) {
  const StrictYaml yaml = StrictYaml::readFile(file);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotationOf(yaml["R"]);
  T.translation() = Eigen::Map<const Eigen::Vector3d>(numbersOf(yaml["T"], 3).data());
  constexpr double kMaxDistance = 100.0;  // m, between two sensors of one vehicle
  if (T.translation().norm() > kMaxDistance)
    yaml["T"].failExpecting("a translation in metres, at most 100 m");
  return T;
}

/// A file of the day's calibration, in the recording or in the folder above it.
fs::path calibrationFile(const fs::path& recording, const char* name) {
  for (const fs::path& place : {recording, fs::absolute(recording).lexically_normal().parent_path()})
    if (fs::exists(place / name)) return place / name;
  throw std::runtime_error(recording.string() + ": " + name +
                           " is neither in it nor in the folder above it; it is part of KITTI's calibration "
                           "of that day, and is needed to compare its GPS and inertial unit with the camera");
}

Eigen::Isometry3d cameraFromUnit(const fs::path& recording) {
  Eigen::Isometry3d R_rectified = Eigen::Isometry3d::Identity();
  R_rectified.linear() =
      rotationOf(StrictYaml::readFile(calibrationFile(recording, "calib_cam_to_cam.txt"))["R_rect_00"]);
  return R_rectified * transformOf(calibrationFile(recording, "calib_velo_to_cam.txt")) *
         transformOf(calibrationFile(recording, "calib_imu_to_velo.txt"));
}

/// Latitude, longitude (deg), altitude (m), roll, pitch, yaw (rad) of a packet.
std::array<double, 6> readPacket(const fs::path& file) {
  const std::vector<double> numbers = numbersOf(readInputText(file, kMaxPacketBytes));
  // Mercator's projection ends at the poles.
  constexpr std::array<double, 6> kLargest{89.0, 360.0, 1e5, 10.0, 10.0, 10.0};
  const bool are_plausible =
      numbers.size() >= kLargest.size() &&
      std::equal(kLargest.begin(), kLargest.end(), numbers.begin(),
                 [](double largest, double number) { return std::abs(number) <= largest; });
  if (!are_plausible) {
    throw std::runtime_error(
        file.string() +
        ": expected the 30 numbers of KITTI's oxts: latitude, longitude, altitude, roll, "
        "pitch, yaw and others");
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]};
}

/// The unit's pose in Mercator's projection, as in KITTI's development kit. `scale`: of the projection, the
/// cosine of the first latitude.
Eigen::Isometry3d poseOf(const std::array<double, 6>& packet, double scale) {
  constexpr double kEarthRadius = 6378137.0;  // m
  const auto& [latitude, longitude, altitude, roll, pitch, yaw] = packet;
  Eigen::Isometry3d T_world_unit = Eigen::Isometry3d::Identity();
  T_world_unit.translation() = Eigen::Vector3d(
      scale * kEarthRadius * longitude / kDegreesPerRadian,
      scale * kEarthRadius * std::log(std::tan((90.0 + latitude) * std::numbers::pi / 360.0)), altitude);
  T_world_unit.linear() =
      (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  return T_world_unit;
}

std::vector<fs::path> packetFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::is_directory(folder)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (entry.path().extension() == ".txt") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Trajectory readKittiOxts(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder / "").lexically_normal().parent_path();
  const fs::path recording = fs::is_directory(whole / "oxts") ? whole : whole.parent_path();
  const fs::path oxts = recording / "oxts";
  const std::vector<fs::path> files = packetFiles(oxts / "data");
  if (files.empty()) {
    throw std::runtime_error(
        folder.string() +
        ": contains no truth; expected a raw recording of KITTI with oxts/timestamps.txt "
        "and oxts/data/0000000000.txt, or a file with poses");
  }
  const std::vector<std::int64_t> instants = capture::readDatesAndTimes(oxts / "timestamps.txt");
  if (instants.size() != files.size()) {
    throw std::runtime_error((oxts / "timestamps.txt").string() + ": has " + std::to_string(instants.size()) +
                             " instants for " + std::to_string(files.size()) + " files in " +
                             (oxts / "data").string());
  }
  const Eigen::Isometry3d T_unit_camera = cameraFromUnit(recording).inverse();
  const double scale = std::cos(readPacket(files.front())[0] / kDegreesPerRadian);
  const Eigen::Isometry3d T_first_world = poseOf(readPacket(files.front()), scale).inverse();
  Trajectory trajectory;
  for (std::size_t i = 0; i < files.size(); ++i) {
    trajectory.push_back({instants[i], T_first_world * poseOf(readPacket(files[i]), scale) * T_unit_camera});
  }
  return trajectory;
}

}  // namespace cartvo
