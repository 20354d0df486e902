#pragma once

#include <memory>

#include "daemon/service/configuration.hpp"

namespace cartvo::daemon {

/// cartvod: connects two cameras, the pipeline, LCM, the log and systemd as the configuration says.
class Daemon {
 public:
  /// Loads the rig, the rectification tables and the passwords and connects to LCM. Throws std::runtime_error
  /// that says what to fix.
  explicit Daemon(const Configuration& configuration);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Runs until `stop`. Throws the error that ended the run.
  void run();

  /// Changes what can be changed while running (ConfigurationChange) with the next odometry message, and logs
  /// what changed and what needs a restart. May be called from any thread.
  void reload(const Configuration& next);

  /// Ends `run`. May be called from any thread.
  void stop() noexcept;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Warning about a configuration that works but is most likely not meant: a rig that does not say how the
/// cameras sit on the cart. Empty: nothing. Throws as checkConfiguration.
std::string configurationWarning(const Configuration& configuration);

/// Checks what can be checked without cameras and LCM: the rig and its rectification, the odometry settings,
/// the passwords, the LCM URL. Throws std::runtime_error that names the fault.
void checkConfiguration(const Configuration& configuration);

}  // namespace cartvo::daemon
