#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/newest_pair.hpp"
#include "vo_core/pose_search.hpp"
#include "vo_core/rig_monitor.hpp"
#include "vo_core/standstill.hpp"

namespace cartvo {

/// The right camera's word on a stand. It is the left pictures that say the cart stands, and those of a left
/// camera that hangs and goes on sending say so wherever it drives. The right camera, whose pose its own
/// picture tells, stays beside the left one, too, or that one is not believed.
class StandWitness {
 public:
  StandWitness(const StereoCamera& camera, const OdometrySettings& settings);

  /// Nothing is known against the left camera.
  void forget();

  /// A pair whose left picture shows no motion against the one before in its window.
  struct Pair {
    NewestPair images;         ///< its pose by the left picture
    std::int64_t exposure_ns;  ///< of the left picture
    bool left_repeats;         ///< whether that is, byte for byte, the one before
    RigMonitor rig;            ///< by which stereo matches are looked for
    const BundleNoises& noise;
    Vector6d admissible_change;  ///< as PoseProblem's
    /// m and rad by which a pair's right camera may be elsewhere than foretold if the cart has stopped since
    /// the pair before: it is exposed at another instant, for which a motion is carried on that has ended.
    double translation_slack, rotation_slack;
  };
  /// What is known of the pair before.
  struct Before {
    const std::vector<WindowFrame>& window;  ///< it is the last
    const std::vector<Landmark>& landmarks;  ///< with its stereo matches
  };
  /// What is worked with: a track has it anyway.
  struct Work {
    PoseProblem& problem;
    std::vector<std::size_t>& chosen;
    PoseFinder& finder;
  };
  /// `landmarks`: the pair's, whose stereo matches are looked for.
  void hear(const Pair& pair, const Before& before, std::vector<Landmark>& landmarks, const Work& work);

  /// Whether it has heard of the pair before, too.
  bool listens() const { return denies_ || stay_.has_value(); }
  /// Whether the right camera has left its place beside the left one, or is nowhere near it, and has not
  /// stayed at another for as long as makes a stand: one that was pushed is a witness again.
  bool denies() const { return denies_; }

 private:
  void state(const Pair& pair, const Before& before, PoseProblem& problem) const;
  struct Stray {
    Eigen::Isometry3d motion;  ///< from where the left camera's pose puts the right one to where it is
    int landmarks = 0;         ///< that say so
  };
  std::optional<Stray> strayOfRight(const std::vector<WindowFrame>& window,
                                    const std::vector<Landmark>& landmarks, const RigMonitor& rig,
                                    const Work& work) const;
  void miss(const Pair& pair);
  struct Stay {
    Stray stray;
    std::int64_t since_ns;
    StandstillSettings limits;
  };

  void note(const Stay& stay);
  Stay stayAt(const Stray& stray, std::int64_t exposure_ns) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  std::optional<Stay> stay_;
  bool denies_ = false;
};

}  // namespace cartvo
