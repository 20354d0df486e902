// Alert limits on a command line.
#include "tools/cartvo/alert_limits_option.hpp"

#include <vector>

#include "common/command_line/parser.hpp"
#include "common/units.hpp"

namespace cartvo {

void addAlertLimitsOption(Command command, std::optional<pipeline::AlertLimits>& limits) {
  command
      .addListOption(
          "--alert-limits",
          [&limits](const std::vector<double>& values) {
            limits = {values[0], kRadiansPerDegree * values[1], values[2], kRadiansPerDegree * values[3]};
          },
          "Largest bounds of valid pairs: of velocity (m/s), angular rate (deg/s), translation (m) and "
          "rotation (deg) over the last second; without it those of the recording's configuration, else "
          "cartvod's")
      .delimiter(',')
      .expected(4)
      .range(1e-3, 1e6)
      .typeName("V,RATE,MOTION,ROTATION");
}

}  // namespace cartvo
