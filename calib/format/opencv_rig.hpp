#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"
#include "common/strict_yaml.hpp"

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

}  // namespace cartvo::calib
