#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace cartvo {

/// Readouts of two cameras, s, as in vo::Shutter.
struct Readouts {
  double left = 0.0;
  double right = 0.0;
};

/// Parses BOTH or LEFT,RIGHT in ms, such as "32" or "32,-30.5". Throws std::invalid_argument that quotes the
/// text.
Readouts parseReadouts(const std::string& milliseconds);

/// Adds --readout-ms of rendered cameras. `milliseconds` must outlive the command; `default_text` ends the
/// description.
CLI::Option* addReadoutOption(CLI::App& command, std::string& milliseconds, const std::string& default_text);

}  // namespace cartvo
