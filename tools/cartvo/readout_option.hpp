#pragma once

#include <array>
#include <optional>
#include <string>

namespace cartvo {

class Command;
class Option;

/// Readouts of two cameras, s, as in vo::Shutter.
struct Readouts {
  double left = 0.0;
  double right = 0.0;
};

/// Reads BOTH or LEFT,RIGHT, each a number of ms of at most `largest_ms` or "unknown". Returns the left and
/// the right readout in s, empty for an unknown one; nothing for other text.
std::optional<std::array<std::optional<double>, 2>> readReadouts(const std::string& text, double largest_ms);

/// Parses BOTH or LEFT,RIGHT in ms, no unknown ones, such as "32" or "32,-30.5". Throws std::invalid_argument
/// that quotes the text.
Readouts parseReadouts(const std::string& milliseconds);

/// Adds --readout-ms of rendered cameras. `milliseconds` must outlive the command; `default_text` ends the
/// description.
Option addReadoutOption(Command command, std::string& milliseconds, const std::string& default_text);

}  // namespace cartvo
