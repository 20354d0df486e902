#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "vo_core/estimation/pose_search.hpp"
#include "vo_core/integrity/standstill.hpp"
#include "vo_core/self_calibration/newest_pair.hpp"
#include "vo_core/self_calibration/rig_calibration_filter.hpp"

namespace cartvo::vo {

/// Detects a left camera that is frozen and continues to send: its images show a standstill wherever the cart
/// drives. During a standstill the right camera, localised by its own image, must stay in place relative to
/// the left one; if it moves, the left camera is frozen.
class FrozenCameraDetector {
 public:
  FrozenCameraDetector(const StereoCamera& camera, const OdometrySettings& settings);

  /// Discards the state: the left camera is not frozen.
  void reset();

  /// A pair whose left image shows no motion relative to the previous pair of its window.
  struct Pair {
    NewestPair images;         ///< with the pose by the left image
    std::int64_t exposure_ns;  ///< of the left image
    bool left_repeats;         ///< whether the left image equals the previous one byte for byte
    RigCalibrationFilter rig;  ///< expected rotation for the search for stereo matches
    const BundleNoises& noise;
    Vector6d admissible_change;  ///< as PoseProblem's
    /// m and rad, added to the limits if the cart has stopped since the previous pair: the pose of the right
    /// camera at its own exposure was then extrapolated from a motion that has ended.
    double translation_slack, rotation_slack;
  };
  /// State of the track at the previous pair.
  struct Before {
    const std::vector<WindowFrame>& window;  ///< the previous pair is the last
    const std::vector<Landmark>& landmarks;  ///< with its stereo matches
  };
  /// Buffers lent by the track.
  struct Work {
    PoseProblem& problem;
    std::vector<std::size_t>& chosen;
    PoseFinder& finder;
  };
  /// Localises the right camera and compares it with its place at the start of the standstill. `landmarks`:
  /// those of the pair, which get its stereo matches.
  void update(const Pair& pair, const Before& before, std::vector<Landmark>& landmarks, const Work& work);

  /// Whether a standstill is being checked, or the left camera was found frozen.
  bool isActive() const { return left_is_frozen_ || start_.has_value(); }
  /// Whether the left camera is frozen: the right camera has moved relative to it, or cannot be localised
  /// while the left image repeats. Reset when the right camera has stayed at a new place for the duration of
  /// a standstill: then it was only pushed.
  bool leftIsFrozen() const { return left_is_frozen_; }

 private:
  /// The right camera localised by its own image.
  struct Displacement {
    Eigen::Isometry3d motion;  ///< from its place by the left camera's pose to its own pose
    int landmarks = 0;         ///< number of inliers
  };
  struct Start {
    Displacement displacement;
    std::int64_t since_ns;
    StandstillSettings limits;
  };

  void setUpProblem(const Pair& pair, const Before& before, PoseProblem& problem) const;
  std::optional<Displacement> localiseRight(const std::vector<WindowFrame>& window,
                                            const std::vector<Landmark>& landmarks,
                                            const RigCalibrationFilter& rig, const Work& work) const;
  void handleLoss(const Pair& pair);
  void compare(const Start& now);
  Start startAt(const Displacement& displacement, std::int64_t exposure_ns) const;

  StereoCamera camera_;
  OdometrySettings settings_;
  std::optional<Start> start_;
  bool left_is_frozen_ = false;
};

}  // namespace cartvo::vo
