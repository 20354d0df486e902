#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo::calib {

// Parts of a rig in the YAML files of other tools. All readers throw std::runtime_error naming file, line,
// key and what was expected.

/// Completes and validates a rig read from another tool's `file`: the mount becomes forwardLookingMount(),
/// since these formats do not contain it. Does not check unusualGeometry(). Throws std::runtime_error with
/// the file's name if the rig is invalid.
Rig importedRig(Rig rig, const std::filesystem::path& file);

/// Reads a file of YAML, or of OpenCV's FileStorage in XML, whose values become those of YAML. Of several
/// messages camera_info of ROS it reads the first. Throws what refuseOtherRigs does.
StrictYaml readYamlOrXml(const std::filesystem::path& file);

/// An image size as [width, height]. MATLAB's is [height, width]: the caller swaps.
cv::Size readImageSize(const StrictYaml& yaml);

/// The elements of a matrix as OpenCV and ROS write it (a map of rows, cols, data), or a sequence of numbers
/// or of rows, row by row; the second form requires `count` of them.
std::vector<double> readMatrix(const StrictYaml& yaml);
std::vector<double> readMatrix(const StrictYaml& yaml, std::size_t count);

/// The rotation with these nine elements, row by row. `yaml` is the value they were read from, for errors.
Eigen::Matrix3d rotationFrom(const std::vector<double>& rows, const StrictYaml& yaml);

/// The transform with these sixteen elements of its 4x4 matrix, row by row. `yaml`: as above.
Eigen::Isometry3d transformFrom(const std::vector<double>& rows, const StrictYaml& yaml);

/// Stores a camera matrix [fx 0 cx; 0 fy cy; 0 0 1], row by row. Throws std::runtime_error naming the number
/// for a matrix with skew, which cartvo's camera model does not have, and for one that is transposed.
void setCameraMatrix(const std::vector<double>& K, const StrictYaml& yaml, CameraModel& camera);

/// Stores the left 3x3 part of a rectified camera's projection matrix [f 0 cx tx; 0 f cy ty; 0 0 1 tz],
/// twelve numbers row by row, and returns the camera's translation against the rectified axes of camera 0, m:
/// the last column is K times it. Throws std::runtime_error for other matrices.
Eigen::Vector3d setProjectionMatrix(const std::vector<double>& P, const StrictYaml& yaml,
                                    CameraModel& camera);

/// Reads [fx, fy, cx, cy], as Kalibr and EuRoC write it, into `camera`.
void readIntrinsics(const StrictYaml& yaml, CameraModel& camera);

/// Stores distortion coefficients, in OpenCV's order for the camera's lens model. Coefficients beyond those
/// of the model must be zero.
void setDistortion(const std::vector<double>& coefficients, const StrictYaml& yaml, CameraModel& camera);

/// The first `count` distortion coefficients of a camera. Throws std::invalid_argument, naming `format`, if a
/// further one is not zero.
std::vector<double> firstCoefficients(const CameraModel& camera, std::size_t count, const char* format);

/// The elements of a 3x3 or 4x4 matrix, row by row.
std::vector<double> rowsOf(const Eigen::Matrix3d& matrix);
std::vector<double> rowsOf(const Eigen::Matrix4d& matrix);

/// [fx 0 cx; 0 fy cy; 0 0 1], row by row.
std::vector<double> cameraMatrixRows(const CameraModel& camera);

}  // namespace cartvo::calib
