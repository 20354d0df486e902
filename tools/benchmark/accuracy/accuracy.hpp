#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/benchmark/sequence.hpp"
#include "tools/evaluate/consistency.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/evaluate/validity/validity_figures.hpp"
#include "tools/replay/replay.hpp"

namespace cartvo::benchmark {

/// Consistency of the stated covariances. All three errors have six dimensions and compare the estimate with
/// the truth in the frame and with the perturbation that the covariance is defined for (on the right, in the
/// axes of the current frame).
struct Consistency {
  /// Error of each measured motion of the left camera, T_previous_current^-1 T_true, against
  /// motion_covariance. Each motion is a group of its own. Zero-velocity updates (motions that are exactly
  /// the identity) are left out if the camera truly moved less than a millimetre: standstill is a decision,
  /// not a measurement.
  NormalisedErrors motion;
  /// Error of the pose of the left camera since the epoch began, T_epoch_left^-1 T_true, against
  /// pose_covariance. All poses of an epoch are one group, so the band of a single drive is wide.
  NormalisedErrors pose;
  /// Error of velocity and angular velocity in body axes, against twist_covariance. The truth is the twist of
  /// the body at the instant of exposure, so the delay of a velocity that is a mean over the time step counts
  /// as an error (compared with the mean, this error would repeat `motion`). Groups and exclusions are those
  /// of `motion`. Empty if the truth has no twist.
  NormalisedErrors velocity;

  void add(const Consistency& other);
};

/// Error of the last pose of a sequence at standstill.
struct EndError {
  double translation = 0.0;  ///< m
  double rotation = 0.0;     ///< rad
};

/// Errors, counts and times of one estimator on one sequence.
struct SequenceAccuracy {
  std::string sequence;
  SequenceKind kind = SequenceKind::real;
  std::optional<WorldSet> set;  ///< see Sequence
  double bitrate_mbps = 0.0;    ///< H.264 bit rate of each camera; 0: lossless images
  std::string estimator;        ///< or a variant of it

  std::size_t pairs = 0;                 ///< processed
  std::size_t lost = 0;                  ///< pairs of the sequence that the pipeline did not form
  std::size_t invalid = 0;               ///< pairs that are not VALID, except the first
  std::size_t resets = 0;                ///< restarts of the pose
  std::size_t standing = 0;              ///< valid pairs whose true motion is a standstill
  double standing_speed = 0.0;           ///< highest reported speed of these pairs, m/s
  Evaluation evaluation;                 ///< of the left camera's path, see tools/evaluate
  std::optional<EndError> standing_end;  ///< of the last pose; set if the path is shorter than 1 m
  Consistency consistency;
  ValidityFigures validity;      ///< of the published messages
  std::vector<double> times_ms;  ///< of each pair except the first, without reading and decoding
};

/// Compares a replay of at least one pair with the truth, and counts published messages above `limits`.
/// Throws std::runtime_error if fewer than two pairs have a true pose.
SequenceAccuracy measureAccuracy(const Replay& replay, const SequenceTruth& truth,
                                 const pipeline::AlertLimits& limits);

/// Combines several sequences into one with the given name: counts are summed; segments, motions and times
/// are pooled; drift and its percentage are means over the moving sequences; standing speed, end error, gap
/// and errors of VALID messages are maxima. Only path length, segments of all lengths, RPE and drift of the
/// evaluation are set. `accuracies` must not be empty.
SequenceAccuracy summarise(const std::string& name, const std::vector<SequenceAccuracy>& accuracies);

}  // namespace cartvo::benchmark
