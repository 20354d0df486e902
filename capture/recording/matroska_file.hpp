#pragma once

#include <filesystem>

namespace cartvo::capture {

/// Whether the Matroska file was finalised by its writer: only then does its header contain the segment's
/// size (RFC 9559, "Unknown-Sized Elements"). False if the file is not Matroska or does not exist.
bool isMatroskaFinalised(const std::filesystem::path& matroska_file);

}  // namespace cartvo::capture
