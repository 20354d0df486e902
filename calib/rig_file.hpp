#pragma once

#include <filesystem>
#include <string>

#include "calib/rig.hpp"

namespace cartvo {

/// Reads a rig: our own YAML format (see config/ and `rigText`), an OpenCV FileStorage, a Kalibr camchain or
/// MATLAB's stereoParameters as JSON, told apart by their contents. Our own is read strictly: an unknown,
/// missing or repeated key, a wrong type or a value out of range throws std::runtime_error naming file, line,
/// key, what was expected and what was found.
Rig readRig(const std::filesystem::path& file);

/// As `readRig`, of a text that lies elsewhere (in a recording); `name` stands for the file in errors.
Rig parseRig(const std::string& text, const std::filesystem::path& name);

/// The rig in our own format, with comments. Reading it gives back the same rig to the last bit.
std::string rigText(const Rig& rig);

/// Writes `rigText`, atomically: a reader, or a power cut, meets the old file or the new one, whole.
void writeRig(const std::filesystem::path& file, const Rig& rig);

/// Throws std::invalid_argument, naming the value, if the rig cannot be one: sizes, focal lengths, rotations,
/// or a baseline between 5 mm and 10 m (a larger one is a calibration in millimetres).
void validateRig(const Rig& rig);

}  // namespace cartvo
