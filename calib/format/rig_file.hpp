#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <opencv2/core/types.hpp>

#include "calib/model/rig.hpp"

namespace cartvo {
class StrictYaml;
}  // namespace cartvo

namespace cartvo::calib {

/// Reads a rig in cartvo's own YAML format (see config/ and `rigText`), an OpenCV FileStorage, a Kalibr
/// camchain or MATLAB's stereoParameters as JSON. The format is recognised by the contents. In cartvo's own
/// format an unknown, missing or repeated key, a wrong type or a value out of range is an error, as is
/// unusualGeometry() without the key `unusual_geometry: true`. Throws
/// std::runtime_error naming file, line, key, what was expected and what was found.
Rig readRig(const std::filesystem::path& file);

/// As `readRig`, from text, for example out of a recording. Error messages name the file `name`. The text
/// cannot name files of masks.
Rig parseRig(const std::string& text, const std::filesystem::path& name);

/// The rig in cartvo's own format. Does not check unusualGeometry(). `folder`: of the file, see readMask.
Rig parseCartvoRig(const StrictYaml& yaml, const std::optional<std::filesystem::path>& folder);

/// The rig in the single files of other tools: OpenCV, Kalibr or MATLAB; nothing if it is none of them. Does
/// not check unusualGeometry(). `image_size` is for files without one.
std::optional<Rig> parseForeignRig(const StrictYaml& yaml, const std::filesystem::path& name,
                                   std::optional<cv::Size> image_size);

/// The rig in cartvo's own format, with comments. Reading it returns the same rig to the last bit. Masks from
/// files are embedded, so that the text stands for itself.
std::string rigText(const Rig& rig);

/// The text of a rig file, for a recording: as it is, or `rigText` if it names files of masks.
std::string portableRigText(const std::filesystem::path& file);

/// Writes the rig as `rigText`, but with the names of the files of masks, atomically, see writeResultFile.
/// Throws std::invalid_argument if the rig is invalid.
void writeRig(const std::filesystem::path& file, const Rig& rig);

}  // namespace cartvo::calib
