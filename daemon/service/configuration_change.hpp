#pragma once

#include <string>
#include <vector>

#include "daemon/service/configuration.hpp"

namespace cartvo::daemon {

/// Keys whose values differ between two configurations, such as "lcm.time_to_live".
struct ConfigurationChange {
  std::vector<std::string> at_run_time;  ///< those that the running daemon can change, see Daemon::reload
  std::vector<std::string> at_restart;   ///< the others

  /// One line for the log: what changed now and what needs a restart.
  std::string text() const;
};

ConfigurationChange compareConfigurations(const Configuration& running, const Configuration& next);

}  // namespace cartvo::daemon
