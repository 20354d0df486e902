// Alert limits on a command line.
#include "tools/cartvo/alert_limits_option.hpp"

#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "common/command_line/parser.hpp"
#include "common/units.hpp"

namespace cartvo {
namespace {

void addOption(Command command, const std::string& description,
               const std::function<void(const pipeline::AlertLimits&)>& set) {
  command
      .addListOption(
          "--alert-limits",
          [set](const std::vector<double>& values) {
            set({values[0], kRadiansPerDegree * values[1], values[2], kRadiansPerDegree * values[3]});
          },
          description)
      .delimiter(',')
      .expected(4)
      .range(1e-3, 1e6)
      .typeName("V,RATE,MOTION,ROTATION");
}

}  // namespace

void addAlertLimitsOption(Command command, std::optional<pipeline::AlertLimits>& limits) {
  addOption(command,
            "Largest bounds of valid pairs: of velocity (m/s), angular rate (deg/s), translation (m) and "
            "rotation (deg) over the last second; without it those of the recording's configuration, else "
            "cartvod's",
            [&limits](const pipeline::AlertLimits& given) { limits = given; });
}

void addAlertLimitsOption(Command command, pipeline::AlertLimits& limits) {
  addOption(
      command,
      fmt::format("Errors above which a VALID message is counted: of a velocity (m/s), an angular rate\n"
                  "(deg/s), and of the motion (m) and rotation (deg) of the last second\n"
                  "(default: those of cartvod, {:g},{:g},{:g},{:g})",
                  limits.velocity, kDegreesPerRadian * limits.angular_rate, limits.motion,
                  kDegreesPerRadian * limits.rotation),
      [&limits](const pipeline::AlertLimits& given) { limits = given; });
}

}  // namespace cartvo
