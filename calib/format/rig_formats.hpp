#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"

namespace cartvo::calib {

/// File formats of rigs. All but cartvo's own lack the mount.
enum class RigFormat : std::uint8_t {
  cartvo,  ///< rig_file.hpp
  opencv,  ///< opencv_rig.hpp
  kalibr,  ///< kalibr_rig.hpp
  matlab,  ///< opencv_rig.hpp
  kitti,   ///< ros_rig.hpp; calib.txt, without the image size
  ros,     ///< ros_rig.hpp; one file per camera
  euroc,   ///< kalibr_rig.hpp; one file per camera
};

/// The names of the formats, in the order of the enumeration.
const std::vector<std::string>& rigFormatNames();

/// The format with this name. Throws std::invalid_argument for an unknown one.
RigFormat parseRigFormat(const std::string& name);

/// How rig files are read.
struct RigReading {
  std::optional<cv::Size> image_size;  ///< of files that do not contain it, or several
  std::array<int, 2> cameras{0, 1};    ///< left and right, of KITTI's files
  bool unusual_geometry = false;       ///< confirms what unusualGeometry() reports
};

/// Reads a rig of any format, which is recognised by its contents: one file, the left and the right camera's,
/// or OpenCV's intrinsics and extrinsics. Throws std::runtime_error naming file, line, key and what was
/// expected, also for a rig of unusualGeometry() that is not confirmed.
Rig readRigFiles(const std::vector<std::filesystem::path>& files, const RigReading& reading = {});

/// A file that contains a rig or one of its cameras.
struct RigFile {
  std::filesystem::path name;  ///< relative to the output folder; empty if the format is a single file
  std::string text;
};

/// The files of a rig in a format. Throws std::invalid_argument with the reason if the format cannot
/// represent it.
std::vector<RigFile> rigFilesOf(const Rig& rig, RigFormat format);

/// The formats that rigs are read from, for errors.
extern const char* const kKnownRigFormats;

/// Throws std::runtime_error for the content of a file that is no text, or a calibration by a tool whose
/// files are not read: the message names the tool, and how to make a file that is read. Otherwise does
/// nothing.
void refuseOtherRigs(const std::string& text, const std::filesystem::path& file);

}  // namespace cartvo::calib
