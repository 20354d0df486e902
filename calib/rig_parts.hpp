#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/rig.hpp"
#include "calib/strict_yaml.hpp"

namespace cartvo {

// What the files of other tools have in common: parts of a rig read from and written as YAML. All readers
// throw std::runtime_error naming file, line, key and what was expected.

/// What a file of another tool holds, as a rig: it knows of no cart, so the camera looks forward; and it has
/// no rules of its own, so it is checked as a rig is, under the file's name.
Rig importedRig(Rig rig, const std::filesystem::path& file);

/// Two sides, [width, height] but in MATLAB.
cv::Size readImageSize(const StrictYaml& yaml);

/// The elements of a matrix (map of rows, cols, data) as OpenCV and ROS write it, row by row.
std::vector<double> readMatrix(const StrictYaml& yaml);
std::vector<double> readMatrix(const StrictYaml& yaml, std::size_t count);

/// A rotation from the nine numbers that `yaml` holds, row by row.
Eigen::Matrix3d rotationFrom(const std::vector<double>& rows, const StrictYaml& yaml);

/// A transform from the sixteen numbers of its 4x4 matrix that `yaml` holds, row by row.
Eigen::Isometry3d transformFrom(const std::vector<double>& rows, const StrictYaml& yaml);

/// [fx, fy, cx, cy] as Kalibr and EuRoC have it.
void readIntrinsics(const StrictYaml& yaml, CameraModel& camera);

/// Coefficients in OpenCV's order for the camera's lens model. More than it has must be zero.
void setDistortion(const std::vector<double>& coefficients, const StrictYaml& yaml, CameraModel& camera);

/// The first `count` coefficients of a camera. Throws std::invalid_argument if others are not zero: `format`
/// cannot hold them.
std::vector<double> firstCoefficients(const CameraModel& camera, std::size_t count, const char* format);

/// The elements of a 3x3 or 4x4 matrix, row by row.
std::vector<double> rowsOf(const Eigen::Matrix3d& matrix);
std::vector<double> rowsOf(const Eigen::Matrix4d& matrix);

/// [fx 0 cx; 0 fy cy; 0 0 1], row by row.
std::vector<double> cameraMatrixRows(const CameraModel& camera);

}  // namespace cartvo
