#pragma once

#include <filesystem>
#include <string>

namespace cartvo {

/// Occupies standard input, output and error output if they are closed, as after `>&-`. Otherwise the next
/// file or socket that is opened would take their place, and output and errors would be written into it. For
/// the start of a program.
void occupyStandardDescriptors();

/// Writes out what standard output still buffers. Returns why not all of the output could be written, with
/// the name of standard output; empty: all was written. For the end of a program, whose exit code would
/// otherwise claim success.
std::string standardOutputError();

/// "PATH: cannot be accessed: REASON", with advice if the current folder does not exist any more.
std::string textOf(const std::filesystem::filesystem_error& error);

}  // namespace cartvo
