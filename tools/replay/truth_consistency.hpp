#pragma once

#include <cstddef>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "tools/evaluate/consistency.hpp"
#include "tools/evaluate/validity/true_twist.hpp"
#include "tools/replay/replay.hpp"
#include "tools/replay/truth.hpp"

namespace cartvo {

/// How the covariances and velocities of a replay agree with the truth. All three normalised errors have six
/// dimensions and compare the estimate with the truth in the frame and with the perturbation that the
/// covariance is defined for (on the right, in the axes of the current frame).
struct TruthConsistency {
  /// Error of each measured motion of the left camera, T_previous_current^-1 T_true, against
  /// motion_covariance. Each motion is a group of its own. Zero-velocity updates (motions that are exactly
  /// the identity) are left out if the camera truly moved less than a millimetre: standstill is a decision,
  /// not a measurement.
  NormalisedErrors motion;
  /// Error of the pose of the left camera since the epoch began, T_epoch_left^-1 T_true, against
  /// pose_covariance. All poses of an epoch are one group, so the band of a single drive is wide.
  NormalisedErrors pose;
  /// Error of velocity and angular velocity in body axes, against twist_covariance. The truth is the twist of
  /// the body at the instant of exposure, so a delay counts as an error. Groups and exclusions are those of
  /// `motion`.
  NormalisedErrors velocity;
  std::size_t standing = 0;     ///< valid pairs whose true motion is a standstill
  double standing_speed = 0.0;  ///< highest reported speed of these pairs, m/s
  double rate_error = 0.0;      ///< rad/s, root mean square of valid angular rates
  double true_rate = 0.0;       ///< rad/s, root mean square of the true ones at the same instants
};

/// `truth`: one pose for each pair. `twist`: of the body, in the time of the pairs.
TruthConsistency consistencyWithTruth(const Replay& replay, const Truth& truth, const TrueTwist& twist);

/// The same with the truth of a file, see readTruth, from which `truth` is.
TruthConsistency consistencyWithTruth(const Replay& replay, const Truth& truth,
                                      const std::filesystem::path& file);

/// Keys that each name their unit; null where there is nothing to measure.
nlohmann::ordered_json consistencyJson(const TruthConsistency& consistency);

}  // namespace cartvo
