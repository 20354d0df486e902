#pragma once

#include <filesystem>
#include <string>

#include "calib/model/rig.hpp"

namespace cartvo {
class StrictYaml;
}  // namespace cartvo

namespace cartvo::calib {

/// Parses MATLAB's stereoParameters as JSON: jsonencode of a struct with the properties CameraParameters1,
/// CameraParameters2 (each with IntrinsicMatrix, RadialDistortion, TangentialDistortion, ImageSize,
/// WorldUnits), RotationOfCamera2 and TranslationOfCamera2. Other properties are ignored. Camera 1 is the
/// left one. (Since R2022b MATLAB prefers K, which is not transposed, and PoseCamera2; the properties used
/// here still exist.)
///
/// MATLAB multiplies row vectors from the left, so its matrices are transposed: IntrinsicMatrix = [fx 0 0;
/// skew fy 0; cx cy 1], and x2 = x1 RotationOfCamera2 + TranslationOfCamera2 takes a point from camera 1 to
/// camera 2. The centre of the first pixel is (1, 1) in MATLAB and (0, 0) here. ImageSize is [rows columns],
/// lengths are in WorldUnits (default: millimetres), and the skew must be zero. (MathWorks' documentation of
/// stereoParameters, cameraParameters, stereoParametersToOpenCV.)
///
/// The rig gets the stem of `name` as its name; error messages name the file `name`. T_body_camera is
/// forwardLookingMount(). Throws std::runtime_error naming file, line, key and what was expected.
Rig parseMatlabRig(const StrictYaml& yaml, const std::filesystem::path& name);

/// The JSON text for a rig, in metres and without the mount. Throws std::invalid_argument for distortion that
/// MATLAB's cameraParameters cannot represent (k4 k5 k6, wide lenses).
std::string matlabText(const Rig& rig);

}  // namespace cartvo::calib
