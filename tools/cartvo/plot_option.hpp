#pragma once

#include <filesystem>
#include <string>

namespace cartvo {

class Command;
class Option;

/// Adds `--plot FILE`, a .svg or .png file; any other name is an error of the command line. `shows`: what is
/// drawn, for the help.
Option addPlotOption(Command command, std::filesystem::path& file, const std::string& shows);

}  // namespace cartvo
