#pragma once

#include <filesystem>

namespace cartvo {

/// Whether whoever wrote the Matroska file came to its end: only then does its beginning say how long it is
/// (RFC 9559, "Unknown-Sized Elements"). False for a file that is no Matroska, or is not there.
bool wasEnded(const std::filesystem::path& matroska_file);

}  // namespace cartvo
