#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "daemon/match_watch.hpp"
#include "vo_core/rig_check.hpp"
#include "vo_core/stereo_odometry.hpp"

namespace cartvo {

/// Says in a plain sentence what driving has shown to be wrong between the two cameras: once it is beyond
/// doubt and large enough to matter, and until it is clearly less; or that they do not seem to see the same.
/// One thread.
class SelfCheck {
 public:
  /// What the last pair told.
  void note(const OdometryEstimate& estimate);

  /// What to mend, for each thing that is wrong; empty if all is well. With the numbers of now.
  std::string sentence() const;

  /// True once for each change of what is wrong.
  bool takeChange();

  const std::optional<RigCheck>& rig() const { return rig_; }

 private:
  static constexpr std::size_t kTold = 4;  ///< delay, pitch, yaw, roll

  void noteRig(const RigCheck& rig);
  bool hidesMatches() const;  ///< whether the angles told explain that matches are missing
  std::string anglesSentence() const;

  std::optional<RigCheck> rig_;
  std::array<bool, kTold> wrong_{};
  MatchWatch matches_;
  bool changed_ = false;
};

}  // namespace cartvo
