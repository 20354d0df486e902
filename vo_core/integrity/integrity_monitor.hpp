#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "vo_core/integrity/picture_stillness.hpp"
#include "vo_core/odometry_estimate.hpp"
#include "vo_core/stereo_masks.hpp"

// Whether images and motions can be trusted: states, the evidence of a pair, and one table of transitions.

namespace cartvo::vo {

/// Observations of a pair, added while the pair is processed: false means no, or not observed yet.
struct IntegrityEvidence {
  bool left_repeats = false;   ///< the left image equals the previous one, by its digest
  bool right_repeats = false;  ///< the right one does
  bool left_alone = false;     ///< the left picture is still, up to noise, while the right one moves
  bool right_alone = false;    ///< the right one is
  bool cannot_stop = false;    ///< the cart was too fast at the last valid motion to have stopped since
  bool no_track = false;       ///< there is no earlier pair to measure a motion from
  bool late = false;           ///< the track's last pair is older than validity.maximum_time_step
  bool by_candidate = false;   ///< the following is what the candidate track observes
  bool stands = false;         ///< the left image's landmarks show no motion
  bool moves = false;          ///< they show a motion
  bool right_moves = false;    ///< the right camera has moved, or cannot be localised while the left repeats
  bool right_stays = false;    ///< the right camera has stayed in place for the time of a standstill
  bool tracked = false;        ///< the motion is valid
  bool zero_velocity = false;  ///< it is a zero-velocity update
  bool lost = false;           ///< the motion is invalid
  bool ambiguous = false;      ///< because the landmarks may as well show another one

  /// Whether an image is none of this pair's instant.
  bool anyRepeats() const { return left_repeats || right_repeats || left_alone || right_alone; }
};

/// Treatment of a pair by the odometry.
enum class IntegrityAction : std::uint8_t {
  measure,      ///< no transition applies yet: more evidence is needed
  publish,      ///< its motion is valid
  reject,       ///< the last pose is repeated
  wait,         ///< the same, until the track's landmarks tell the motions apart
  relocalise,   ///< the same, and the candidate track is tried
  start_epoch,  ///< a new epoch starts at the pair
};

/// A row of the table: from each state of the set, on all of the evidence `with` and none of `without`.
struct IntegrityTransition {
  using Condition = bool IntegrityEvidence::*;
  std::uint8_t from;              ///< set of states, a bit for each
  std::array<Condition, 3> with;  ///< the first ones; the others are nullptr
  Condition without;              ///< nullptr: none
  IntegrityState to;
  IntegrityAction action;

  constexpr bool isFrom(IntegrityState state) const { return ((from >> static_cast<int>(state)) & 1) != 0; }
  bool appliesTo(IntegrityState state, const IntegrityEvidence& evidence) const;
};

/// The table, in the order of precedence.
std::span<const IntegrityTransition> integrityTransitions();

struct IntegrityDecision {
  IntegrityState state;
  IntegrityAction action;
};

/// The first transition that applies; the same state and `measure` if none does.
IntegrityDecision decide(IntegrityState state, const IntegrityEvidence& evidence);

/// Keeps the state from pair to pair, and what the evidence of the next one is compared with.
class IntegrityMonitor {
 public:
  /// Keeps headers of the masks: their pixels must not change.
  explicit IntegrityMonitor(const StereoMasks& masks) : masks_(masks) {}

  /// Compares the next pair's images with the previous ones. Masked pixels are not compared: a clock that a
  /// camera writes into its images goes on when they are frozen.
  void beginPair(const StereoImages& images);
  const IntegrityEvidence& evidence() const { return evidence_; }  ///< what beginPair() has observed

  /// Applies the table to the evidence. Called for a pair whenever there is more of it.
  IntegrityAction update(const IntegrityEvidence& evidence);
  /// Writes the state into the pair's estimate.
  void endPair(OdometryEstimate& estimate);
  IntegrityState state() const { return state_; }

 private:
  StereoMasks masks_;
  IntegrityState state_ = IntegrityState::lost;
  IntegrityEvidence evidence_;
  PictureStillness stillness_;
  std::optional<std::array<std::uint64_t, 2>> digests_;  ///< of the last pair's images
  Vector6d velocity_ = Vector6d::Zero();  ///< m/s and rad/s, at least, at the last valid motion
  std::int64_t velocity_ns_ = 0;          ///< its exposure
};

}  // namespace cartvo::vo
