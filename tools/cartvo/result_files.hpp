#pragma once

#include <filesystem>
#include <initializer_list>

namespace cartvo {

/// Throws std::runtime_error if one of the files cannot be written, see checkFileCanBeWritten. For use before
/// the work. Empty paths are skipped.
void checkResultFiles(std::initializer_list<std::filesystem::path> files);

}  // namespace cartvo
