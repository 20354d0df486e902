#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/benchmark/consistency.hpp"
#include "tools/benchmark/sequence.hpp"
#include "tools/evaluate/evaluation.hpp"
#include "tools/replay/replay.hpp"

namespace cartvo::benchmark {

/// Whether the stated covariances are right. All three errors are of six dimensions, estimate against truth
/// in the frame and with the perturbation that the covariance is stated for (on the right, in the axes of the
/// current frame).
struct Consistency {
  /// Of each measured motion, left camera: T_previous_current^-1 T_true, against motion_covariance. A group
  /// each. Left out are motions declared to be none (exactly the identity) while the camera moved less than a
  /// millimetre: standing still is a decision, not a measurement.
  NormalisedErrors motion;
  /// Of the pose since the epoch began, left camera: T_epoch_left^-1 T_true, against pose_covariance. All
  /// poses of an epoch are one group, so that the band of one drive is wide.
  NormalisedErrors pose;
  /// Of velocity and angular velocity in body axes, against twist_covariance: the truth is the body's twist
  /// at the instant of the exposure, so that the delay of a velocity that is a mean over the time step counts
  /// as an error (against that mean it would be the motion's once more). A group each; the same are left out.
  /// None where the truth does not tell the twist.
  NormalisedErrors velocity;

  void add(const Consistency& other);
};

struct EndError {
  double translation = 0.0;  ///< m
  double rotation = 0.0;     ///< rad
};

/// What one estimator made of one sequence.
struct SequenceAccuracy {
  std::string sequence;
  SequenceKind kind = SequenceKind::real;
  double bitrate_mbps = 0.0;  ///< of each camera's H.264; 0: the pictures as they are
  std::string estimator;      ///< or the variant of it

  std::size_t pairs = 0;                 ///< processed
  std::size_t lost = 0;                  ///< of the sequence, but never became a pair
  std::size_t invalid = 0;               ///< without an estimate, the first pair aside
  std::size_t resets = 0;                ///< times the pose began anew
  std::size_t wrong = 0;                 ///< valid, but wrong: see isWrong
  std::size_t standing = 0;              ///< valid pairs before and at which the cart truly stood
  double standing_speed = 0.0;           ///< the highest reported at them, m/s
  Evaluation evaluation;                 ///< of the left camera's path, see tools/evaluate
  std::optional<EndError> standing_end;  ///< where it stands (the path is shorter than 1 m): of the last pose
  Consistency consistency;
  std::vector<double> times_ms;  ///< of each pair, the first aside; reading and decoding are no part of it
};

/// Whether a motion is off by more than 5 cm or 0.5 degrees that its covariance does not own up to: beyond
/// five standard deviations (Mahalanobis distance of the three components concerned). `error` and
/// `covariance`: (x, y, z, rotation), m and rad.
bool isWrong(const Vector6d& error, const Matrix6d& covariance);

/// Compares a replay, which must hold a pair, with the truth. Throws std::runtime_error if fewer than two
/// pairs have a truth.
SequenceAccuracy measureAccuracy(const Replay& replay, const SequenceTruth& truth);

/// Many sequences as one, `name`d: counts are sums, segments, motions and times of all are taken together,
/// drift and its percentage are means over the sequences that move, standing speed and end error the largest.
/// Of the evaluation only path length, segments of all lengths, RPE and drift are set. `accuracies` must not
/// be empty.
SequenceAccuracy summarise(const std::string& name, const std::vector<SequenceAccuracy>& accuracies);

}  // namespace cartvo::benchmark
