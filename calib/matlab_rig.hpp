#pragma once

#include <filesystem>
#include <string>

#include "calib/rig.hpp"

namespace cartvo {

class StrictYaml;

/// MATLAB's stereoParameters as JSON: jsonencode of a struct of the properties CameraParameters1,
/// CameraParameters2 (each with IntrinsicMatrix, RadialDistortion, TangentialDistortion, ImageSize,
/// WorldUnits), RotationOfCamera2 and TranslationOfCamera2; others are let be. Camera 1 is the left one.
/// (From R2022b on MATLAB prefers K, which is not transposed, and PoseCamera2; these here are still there.)
///
/// MATLAB multiplies row vectors from the left, so its matrices are the transposed ones:
/// IntrinsicMatrix = [fx 0 0; skew fy 0; cx cy 1], and a point goes from camera 1 to camera 2 by
/// x2 = x1 RotationOfCamera2 + TranslationOfCamera2. The centre of its first pixel is (1, 1), ours (0, 0).
/// ImageSize is [rows columns], lengths are in WorldUnits (millimetres unless said otherwise), the skew must
/// be zero. (MathWorks' documentation of stereoParameters, cameraParameters, stereoParametersToOpenCV.)
///
/// `name` gives the rig its name and stands for the file in errors, which are std::runtime_error;
/// T_body_camera is forwardLookingMount().
Rig matlabRig(const StrictYaml& yaml, const std::filesystem::path& name);

/// Such a file of a rig, in metres, without its mount. Throws std::invalid_argument for distortion that
/// MATLAB's cameraParameters cannot hold (k4 k5 k6, wide lenses).
std::string matlabText(const Rig& rig);

}  // namespace cartvo
