#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/newest_pair.hpp"
#include "vo_core/rig_monitor.hpp"

namespace cartvo {

/// Hears what driving tells of the rig where a track's measurements are not corrected, and leaves the track
/// as it is. A yaw makes depths, and by them the window's scale, so wrong that equations linear in it see a
/// fifth of it; so the window is adjusted once more, by itself and as far as the rig is known by now, to find
/// the rest. Each tenth pair is heard: no two of these share a sighting.
class RigWitness {
 public:
  RigWitness(const StereoCamera& camera, const OdometrySettings& settings, std::int64_t first_exposure_ns)
      : camera_(camera), settings_(settings), heard_ns_(first_exposure_ns) {}

  /// A pair that the track has taken in, and all its landmarks: if its turn has come, `rig` learns from it.
  void take(const NewestPair& pair, const std::vector<Landmark>& all, RigMonitor& rig);

 private:
  bool hidesMatches(const RigMonitor& rig) const;
  bool hidesTheFar(const RigMonitor& rig) const;
  void matchAnew(const NewestPair& pair, const RigMonitor& rig, std::vector<Landmark>& landmarks) const;
  void matchByDepth(const NewestPair& pair, const RigMonitor& rig, std::vector<Landmark>& landmarks) const;
  BundleProblem problemOf(const NewestPair& pair, const std::vector<Landmark>& landmarks,
                          const RigCorrection& rig) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  BundleNoises noise_;
  std::int64_t heard_ns_;  ///< exposure of the last pair that was heard, else of the track's first
  int pairs_ = 0;          ///< since the last one whose turn it was
};

}  // namespace cartvo
