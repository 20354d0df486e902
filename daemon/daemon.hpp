#pragma once

#include <memory>

#include "daemon/configuration.hpp"

namespace cartvo {

/// cartvod: two cameras, the pipeline, LCM, the log and systemd, put together from a configuration.
class Daemon {
 public:
  /// Loads the rig, the tables and the passwords and connects to LCM. Throws std::runtime_error with a
  /// message a person can act on.
  explicit Daemon(const Configuration& configuration);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Runs until `stop`. Throws what makes going on impossible.
  void run();

  /// From any thread.
  void stop() noexcept;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Checks all that can be checked without cameras and LCM: the rig and its rectification, the passwords.
/// Throws std::runtime_error for what is wrong.
void checkConfiguration(const Configuration& configuration);

}  // namespace cartvo
