#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>

namespace cartvo {

class Command;
class Option;

/// Adds `--plot FILE`, a .svg or .png file; any other name is an error of the command line. `shows`: what is
/// drawn, for the help.
Option addPlotOption(Command command, std::filesystem::path& file, const std::string& shows);

/// Throws std::runtime_error if one of the files cannot be written, see checkFileCanBeWritten. For use before
/// the work. Empty paths are skipped.
void checkResultFiles(std::initializer_list<std::filesystem::path> files);

}  // namespace cartvo
