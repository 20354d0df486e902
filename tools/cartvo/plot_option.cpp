// An option for a drawing.
#include "tools/cartvo/plot_option.hpp"

#include <exception>
#include <string>

#include "common/command_line/parser.hpp"
#include "tools/report/drawing.hpp"

namespace cartvo {

Option addPlotOption(Command command, std::filesystem::path& file, const std::string& shows) {
  const auto check_name = [](const std::string& name) -> std::string {
    try {
      checkDrawingName(name);
    } catch (const std::exception& error) {
      return error.what();
    }
    return {};
  };
  return command.addOption("--plot", file, "Draw " + shows + " into this .svg or .png file")
      .check(check_name)
      .typeName("FILE");
}

}  // namespace cartvo
