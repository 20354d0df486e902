#pragma once

#include <string>
#include <vector>

#include <spdlog/common.h>

#include "daemon/service/configuration.hpp"

namespace cartvo::daemon {

/// Keys whose values differ between two configurations, such as "lcm.time_to_live".
struct ConfigurationChange {
  std::vector<std::string> at_run_time;  ///< those that the running daemon can change, see Daemon::reload
  std::vector<std::string> at_restart;   ///< the others

  /// Logs what changes now as information and what needs a restart as a warning, and sets the log's level to
  /// `next`. A line is written if the level before or the next one shows it.
  void logAndSetLevel(spdlog::level::level_enum next) const;
};

ConfigurationChange compareConfigurations(const Configuration& running, const Configuration& next);

}  // namespace cartvo::daemon
