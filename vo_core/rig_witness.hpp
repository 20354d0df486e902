#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/bundle_adjustment.hpp"
#include "vo_core/landmark_tracker.hpp"
#include "vo_core/rig_monitor.hpp"

namespace cartvo {

/// What a track knows once it has taken a pair in.
struct TrackedPair {
  const LandmarkTracker& tracker;
  const ImagePyramid& left;
  const ImagePyramid& right;
  const std::vector<Landmark>& landmarks;
  const std::vector<WindowFrame>& window;  ///< the pair is the last
};

/// Hears what driving tells of the rig where a track's measurements are not corrected, and leaves the track
/// as it is. A yaw makes depths, and by them the window's scale, so wrong that equations linear in it see a
/// fifth of it; so the window is adjusted once more, by itself and as far as the rig is known by now, to find
/// the rest. Each tenth pair is heard: no two of these share a sighting.
class RigWitness {
 public:
  RigWitness(const StereoCamera& camera, const OdometrySettings& settings, std::int64_t first_exposure_ns)
      : camera_(camera), settings_(settings), heard_ns_(first_exposure_ns) {}

  /// A pair that the track has taken in; if its turn has come, `rig` learns from it.
  void take(const TrackedPair& pair, RigMonitor& rig);

 private:
  std::vector<Landmark> chosenOf(const TrackedPair& pair) const;
  bool hidesMatches(const RigMonitor& rig) const;
  bool hidesTheFar(const RigMonitor& rig) const;
  void matchTurned(const TrackedPair& pair, const RigMonitor& rig, double baseline,
                   std::vector<Landmark>& landmarks) const;
  void matchAnew(const TrackedPair& pair, const RigMonitor& rig, std::vector<Landmark>& landmarks) const;
  void matchByDepth(const TrackedPair& pair, const RigMonitor& rig, std::vector<Landmark>& landmarks) const;
  BundleProblem problemOf(const TrackedPair& pair, const std::vector<Landmark>& landmarks,
                          const RigCorrection& rig) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  BundleNoise noise_;
  std::int64_t heard_ns_;  ///< exposure of the last pair that was heard, else of the track's first
  int pairs_ = 0;          ///< since the last one whose turn it was
};

}  // namespace cartvo
