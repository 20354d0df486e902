#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pipeline/pair_processor.hpp"

namespace cartvo::daemon {

/// Detects missing stereo matches: for five seconds the left images had many corners, but hardly any was
/// found in the right ones. So few matches do not determine by which angle a camera is turned, so the message
/// lists what to check. Not thread-safe.
class StereoMatchMonitor {
 public:
  void update(const vo::OdometryEstimate& estimate);

  bool matchesMissing() const { return missing_; }
  /// Possible causes; empty if matches are not missing.
  std::string message() const;

 private:
  std::optional<std::int64_t> since_ns_;  ///< exposure of the first consecutive pair without matches
  std::int64_t last_ns_ = 0;              ///< exposure of the last one
  bool missing_ = false;
};

}  // namespace cartvo::daemon
