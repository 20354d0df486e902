#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/rig.hpp"

namespace cartvo {

/// The files that rigs are kept in. All but our own leave out how the rig sits on the cart.
enum class RigFormat : std::uint8_t {
  cartvo,  ///< rig_file.hpp
  opencv,  ///< opencv_rig.hpp
  kalibr,  ///< kalibr_rig.hpp
  matlab,  ///< matlab_rig.hpp
  kitti,   ///< kitti_rig.hpp; does not say how large the images are
  ros,     ///< ros_rig.hpp; a file for each camera
  euroc,   ///< euroc_rig.hpp; a file for each camera
};

/// Names of the formats, as in the enumeration.
const std::vector<std::string>& rigFormatNames();

/// The format of one of these names. Throws std::invalid_argument for another.
RigFormat rigFormatNamed(const std::string& name);

/// Reads a rig in whichever format, told by the contents: one file, or the left and the right camera's.
/// `image_size` is for KITTI's calib.txt only. Throws std::runtime_error naming file, line, key and what was
/// expected.
Rig readRigFiles(const std::vector<std::filesystem::path>& files, std::optional<cv::Size> image_size);

/// A file that holds a rig or a part of it.
struct RigFile {
  std::filesystem::path name;  ///< within a folder; empty where the rig is one file
  std::string text;
};

/// The files of a rig. Throws std::invalid_argument, saying why, if the format cannot hold it.
std::vector<RigFile> rigFilesOf(const Rig& rig, RigFormat format);

}  // namespace cartvo
