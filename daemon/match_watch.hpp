#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// Notices that for some seconds corners have been plenty in the left images, but hardly any was found in the
/// right ones. The rows of so few do not tell by which angle a camera is turned, but a person can see what is
/// wrong. One thread.
class MatchWatch {
 public:
  void note(const OdometryEstimate& estimate);

  bool missing() const { return missing_; }
  /// What may be wrong, with the numbers of the last pair; empty if matches are not missing.
  std::string sentence() const;

 private:
  std::optional<std::int64_t> since_ns_;  ///< exposure of the first pair in a row without matches
  std::int64_t last_ns_ = 0;              ///< of the last one of that row
  bool missing_ = false;
  FeatureCounts counts_;
};

}  // namespace cartvo
