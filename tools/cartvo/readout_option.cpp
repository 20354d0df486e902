// Parses the readouts of two cameras on a command line.
#include "tools/simulate/readout_option.hpp"

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <stdexcept>

namespace cartvo {

Readouts parseReadouts(const std::string& milliseconds) {
  const auto fail = [&milliseconds]() -> Readouts {
    throw std::invalid_argument("'" + milliseconds +
                                "' is not the readout of both cameras or LEFT,RIGHT in ms between -100 and "
                                "100, such as 32 or 32,-30.5");
  };
  const auto number = [&fail](const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !(std::abs(value) <= 100.0)) fail();
    return 1e-3 * value;
  };
  const std::size_t comma = milliseconds.find(',');
  const double left = number(milliseconds.substr(0, comma));
  return {left, comma == std::string::npos ? left : number(milliseconds.substr(comma + 1))};
}

CLI::Option* addReadoutOption(CLI::App& command, std::string& milliseconds, const std::string& default_text) {
  return command
      .add_option("--readout-ms", milliseconds,
                  "Time from the exposure of the upper edge of a rendered image to that of the\n"
                  "lower one, of both cameras or of each; 0: a global shutter; negative: the rows\n"
                  "are exposed from bottom to top. An image counts at its middle row's exposure\n(" +
                      default_text + ")")
      ->type_name("BOTH|LEFT,RIGHT")
      ->check([](const std::string& text) -> std::string {
        try {
          parseReadouts(text);
          return {};
        } catch (const std::invalid_argument& error) {
          return error.what();
        }
      });
}

}  // namespace cartvo
