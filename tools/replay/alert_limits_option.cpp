// The option --alert-limits of commands that replay.
#include "tools/replay/alert_limits_option.hpp"

#include <vector>

#include <CLI/CLI.hpp>

#include "common/units.hpp"

namespace cartvo {

void addAlertLimitsOption(CLI::App& command, std::optional<daemon::AlertLimits>& limits) {
  const auto set = [&limits](const std::vector<double>& values) {
    limits = {values[0], kRadiansPerDegree * values[1], values[2], kRadiansPerDegree * values[3]};
  };
  command
      .add_option_function<std::vector<double>>(
          "--alert-limits", set,
          "Largest bounds of valid pairs: of velocity (m/s), angular rate (deg/s), translation (m) and "
          "rotation "
          "(deg) over the last second; without it those of the recording's configuration, else cartvod's")
      ->delimiter(',')
      ->expected(4)
      ->check(CLI::Range(1e-3, 1e6))
      ->type_name("V,RATE,MOTION,ROTATION");
}

}  // namespace cartvo
