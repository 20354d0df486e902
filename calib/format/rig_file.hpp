#pragma once

#include <filesystem>
#include <string>

#include "calib/model/rig.hpp"

namespace cartvo::calib {

/// Reads a rig in cartvo's own YAML format (see config/ and `rigText`), an OpenCV FileStorage, a Kalibr
/// camchain or MATLAB's stereoParameters as JSON. The format is recognised by the contents. In cartvo's own
/// format an unknown, missing or repeated key, a wrong type or a value out of range is an error. Throws
/// std::runtime_error naming file, line, key, what was expected and what was found.
Rig readRig(const std::filesystem::path& file);

/// As `readRig`, from text, for example out of a recording. Error messages name the file `name`.
Rig parseRig(const std::string& text, const std::filesystem::path& name);

/// The rig in cartvo's own format, with comments. Reading it returns the same rig to the last bit.
std::string rigText(const Rig& rig);

/// Writes `rigText` atomically, see writeResultFile. Throws std::invalid_argument if the rig is invalid.
void writeRig(const std::filesystem::path& file, const Rig& rig);

}  // namespace cartvo::calib
