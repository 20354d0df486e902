#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

#include "common/command_line/cli11_forward.hpp"

namespace cartvo {

/// Adds `--plot FILE`, a .svg or .png file; any other name is an error of the command line. `shows`: what is
/// drawn, for the help.
CLI::Option* addPlotOption(CLI::App& command, std::filesystem::path& file, const std::string& shows);

/// Throws std::runtime_error if one of the files cannot be written, see checkFileCanBeWritten. For use before
/// the work. Empty paths are skipped.
void checkResultFiles(std::initializer_list<std::filesystem::path> files);

}  // namespace cartvo
