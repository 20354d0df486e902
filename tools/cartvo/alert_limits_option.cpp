// The alert limits of a report on a command line.
#include "tools/cartvo/alert_limits_option.hpp"

#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/units.hpp"

namespace cartvo {

CLI::Option* addAlertLimitsOption(CLI::App& command, daemon::AlertLimits& limits) {
  return command
      .add_option_function<std::vector<double>>(
          "--alert-limits",
          [&limits](const std::vector<double>& values) {
            limits = {values[0], kRadiansPerDegree * values[1], values[2], kRadiansPerDegree * values[3]};
          },
          fmt::format("Errors above which a VALID message is counted: of a velocity (m/s), an angular rate\n"
                      "(deg/s), and of the motion (m) and rotation (deg) of the last second\n"
                      "(default: those of cartvod, {:g},{:g},{:g},{:g})",
                      limits.velocity, kDegreesPerRadian * limits.angular_rate, limits.motion,
                      kDegreesPerRadian * limits.rotation))
      ->delimiter(',')
      ->expected(4)
      ->check(CLI::PositiveNumber)
      ->type_name("LIST");
}

}  // namespace cartvo
