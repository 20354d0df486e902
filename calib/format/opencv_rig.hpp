#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"
#include "common/strict_yaml.hpp"

namespace cartvo {
class StrictYaml;
}  // namespace cartvo

namespace cartvo::calib {

/// Whether a file contains intrinsics or extrinsics in OpenCV's FileStorage format.
bool isOpenCvRig(const StrictYaml& yaml);

/// Parses OpenCV FileStorages (YAML) as cv::stereoCalibrate's results are stored: camera matrices K1 K2 (also
/// M1 M2, cameraMatrix1 cameraMatrix2), distortion D1 D2 (also distCoeffs1 distCoeffs2), R and T, which take
/// the left camera's axes to the right's, T in metres. Each file has some of them: OpenCV's sample
/// stereo_calib writes intrinsics.yml and extrinsics.yml. The image size is `image_size`, `imageSize`, or
/// `image_width` and `image_height`, or the given one. With `fisheye_model: 1` (as OpenCV's calibration
/// sample writes it), or a model's name such as `distortion_model: equidistant`, the distortion is that of
/// cv::fisheye; without either, four coefficients that may be those of both models are refused. P2, if it is
/// there, must agree with T. Other keys are derived from these, and ignored; thin-prism and tilt coefficients
/// must be zero. T_body_camera is forwardLookingMount(). The rig gets the stem of `name` as its name; error
/// messages name the file `name`. Throws std::runtime_error naming file, line, key and what was expected.
Rig parseOpenCvRig(const std::vector<StrictYaml>& files, const std::filesystem::path& name,
                   std::optional<cv::Size> image_size = {});

/// The FileStorage text of a rig, without the mount. Throws std::invalid_argument if its cameras have
/// different lens models.
std::string openCvText(const Rig& rig);

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
