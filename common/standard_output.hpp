#pragma once

#include <string>

namespace cartvo {

/// Writes out what standard output still buffers. Returns why not all of the output could be written, with
/// the name of standard output; empty: all was written. For the end of a program, whose exit code would
/// otherwise claim success.
std::string standardOutputError();

}  // namespace cartvo
