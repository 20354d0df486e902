#pragma once

#include <filesystem>
#include <string>

namespace cartvo::calib {

/// The formats that rigs are read from, for errors.
extern const char* const kKnownRigFormats;

/// Throws std::runtime_error for the content of a file that is no text, or a calibration by a tool whose
/// files are not read: the message names the tool, and how to make a file that is read. Otherwise does
/// nothing.
void refuseOtherRigs(const std::string& text, const std::filesystem::path& file);

}  // namespace cartvo::calib
