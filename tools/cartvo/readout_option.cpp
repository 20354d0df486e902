// Parses the readouts of two cameras on a command line.
#include "tools/cartvo/readout_option.hpp"

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>

#include "common/command_line/parser.hpp"

namespace cartvo {

std::optional<std::array<std::optional<double>, 2>> readReadouts(const std::string& text, double largest_ms) {
  const std::size_t comma = text.find(',');
  const std::string left = text.substr(0, comma);
  std::array<std::optional<double>, 2> readouts;
  const std::array<std::string, 2> words{left, comma == std::string::npos ? left : text.substr(comma + 1)};
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "unknown") continue;
    char* end = nullptr;
    const double milliseconds = std::strtod(words[i].c_str(), &end);
    if (words[i].empty() || *end != '\0' || !(std::abs(milliseconds) <= largest_ms)) return std::nullopt;
    readouts[i] = 1e-3 * milliseconds;
  }
  return readouts;
}

Readouts parseReadouts(const std::string& milliseconds) {
  const auto readouts = readReadouts(milliseconds, 100.0);
  if (!readouts || !(*readouts)[0] || !(*readouts)[1])
    throw std::invalid_argument("'" + milliseconds +
                                "' is not the readout of both cameras or LEFT,RIGHT in ms between -100 and "
                                "100, such as 32 or 32,-30.5");
  return {*(*readouts)[0], *(*readouts)[1]};
}

Option addReadoutOption(Command command, std::string& milliseconds, const std::string& default_text) {
  return command
      .addOption("--readout-ms", milliseconds,
                 "Time from the exposure of the upper edge of a rendered image to that of the\n"
                 "lower one, of both cameras or of each; 0: a global shutter; negative: the rows\n"
                 "are exposed from bottom to top. An image counts at its middle row's exposure\n(" +
                     default_text + ")")
      .typeName("BOTH|LEFT,RIGHT")
      .check([](const std::string& text) -> std::string {
        try {
          parseReadouts(text);
          return {};
        } catch (const std::invalid_argument& error) {
          return error.what();
        }
      });
}

}  // namespace cartvo
