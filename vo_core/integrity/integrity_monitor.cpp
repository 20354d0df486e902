// The table of the integrity's transitions, and the evidence that images alone give.
#include "vo_core/integrity/integrity_monitor.hpp"

#include <algorithm>

#include "common/picture_digest.hpp"
#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/plausible_motion.hpp"

namespace cartvo::vo {
namespace {

using enum IntegrityState;
using enum IntegrityAction;
using E = IntegrityEvidence;

template <typename... States>
constexpr std::uint8_t setOf(States... states) {
  return static_cast<std::uint8_t>(((1U << static_cast<unsigned>(states)) | ...));
}

constexpr std::uint8_t kAny = setOf(tracking, standstill, left_frozen, right_frozen, both_frozen, lost);
constexpr std::uint8_t kNotBoth = kAny & ~setOf(both_frozen);
constexpr std::uint8_t kLeftFrozen = setOf(left_frozen, both_frozen);
constexpr std::uint8_t kLeftRuns = kAny & ~kLeftFrozen;

constexpr std::array kTransitions = std::to_array<IntegrityTransition>({
    // Images that repeat although the cart cannot have stopped, and as long as they repeat.
    {kAny, {&E::left_repeats, &E::right_repeats, &E::cannot_stop}, {}, both_frozen, reject},
    {kNotBoth, {&E::left_repeats, &E::cannot_stop}, {}, left_frozen, reject},
    {kNotBoth, {&E::right_repeats, &E::cannot_stop}, {}, right_frozen, reject},
    {setOf(both_frozen), {&E::left_repeats}, {}, both_frozen, reject},
    {setOf(both_frozen), {&E::right_repeats}, {}, both_frozen, reject},
    {setOf(left_frozen), {&E::left_repeats}, {}, left_frozen, reject},
    {setOf(right_frozen), {&E::right_repeats}, {}, right_frozen, reject},
    // A picture that is still, up to noise, while the other camera moves.
    {kAny, {&E::left_alone}, {}, left_frozen, reject},
    {kAny, {&E::right_alone}, {}, right_frozen, reject},
    // No pair to measure from. The track of a frozen left camera is continued until the camera recovers.
    {kAny, {&E::no_track}, {}, lost, start_epoch},
    {kLeftRuns, {&E::late}, {}, lost, start_epoch},
    // The left image's motion against the right camera, and against the bound on braking: a stop that exceeds
    // the bound must show in two pairs.
    {kNotBoth & ~setOf(right_frozen), {&E::moves, &E::right_repeats}, {}, right_frozen, reject},
    {kNotBoth, {&E::stands, &E::right_moves}, {}, left_frozen, reject},
    {setOf(left_frozen), {&E::stands}, &E::right_stays, left_frozen, reject},
    {setOf(both_frozen), {&E::stands}, {}, both_frozen, reject},
    {setOf(lost), {&E::stands, &E::cannot_stop}, {}, both_frozen, reject},
    {kNotBoth & ~setOf(lost), {&E::stands, &E::cannot_stop}, {}, lost, relocalise},
    // A frozen image ends, at an unknown distance if late. A candidate may have started at such an image.
    {kLeftFrozen, {&E::late, &E::tracked}, {}, lost, start_epoch},
    {kLeftFrozen, {&E::late, &E::lost, &E::by_candidate}, {}, lost, start_epoch},
    {kLeftFrozen, {&E::tracked, &E::by_candidate}, {}, lost, relocalise},
    {kNotBoth, {&E::tracked, &E::zero_velocity}, {}, standstill, publish},
    {kAny, {&E::tracked}, {}, tracking, publish},
    {setOf(left_frozen), {&E::lost}, {}, left_frozen, relocalise},
    {setOf(both_frozen), {&E::lost}, {}, both_frozen, relocalise},
    // The farther the cart has come, the more of the track's landmarks tell two motions apart; those of a
    // candidate track begin here.
    {kLeftRuns, {&E::lost, &E::ambiguous}, &E::by_candidate, lost, wait},
    {kLeftRuns, {&E::lost}, {}, lost, relocalise},
});

}  // namespace

bool IntegrityTransition::appliesTo(IntegrityState state, const IntegrityEvidence& evidence) const {
  return isFrom(state) && (without == nullptr || !(evidence.*without)) &&
         std::all_of(with.begin(), with.end(),
                     [&](Condition condition) { return condition == nullptr || evidence.*condition; });
}

std::span<const IntegrityTransition> integrityTransitions() {
  return kTransitions;
}

IntegrityDecision decide(IntegrityState state, const IntegrityEvidence& evidence) {
  for (const IntegrityTransition& row : kTransitions)
    if (row.appliesTo(state, evidence)) return {row.to, row.action};
  return {state, measure};
}

void IntegrityMonitor::beginPair(const StereoImages& images) {
  const std::array digests{pictureDigest(images.left, masks_.left),
                           pictureDigest(images.right, masks_.right)};
  evidence_ = {};
  // An encoder gives the uniform pictures of a covered lens without noise: they repeat with a good camera.
  evidence_.left_repeats = digests_ && digests[0] == (*digests_)[0] && !isUniform(images.left);
  evidence_.right_repeats = digests_ && digests[1] == (*digests_)[1] && !isUniform(images.right);
  stillness_.update(images, masks_);
  evidence_.left_alone = stillness_.leftAlone();
  evidence_.right_alone = stillness_.rightAlone();
  evidence_.cannot_stop =
      !canStop(velocity_, 1e-9 * static_cast<double>(images.left_exposure_ns - velocity_ns_));
  digests_ = digests;
}

IntegrityAction IntegrityMonitor::update(const IntegrityEvidence& evidence) {
  const IntegrityDecision decision = decide(state_, evidence);
  state_ = decision.state;
  return decision.action;
}

void IntegrityMonitor::endPair(OdometryEstimate& estimate) {
  estimate.state = state_;
  if (!estimate.valid) return;
  // As much as is certain: noise of a camera at rest is no speed.
  const Vector6d motion = vectorFromMotion(estimate.T_previous_current);
  const Vector6d bound = protection::kBoundFactor * estimate.motion_covariance.diagonal().cwiseSqrt();
  velocity_ = (motion - motion.cwiseMax(-bound).cwiseMin(bound)) / estimate.time_step;
  velocity_ns_ = estimate.exposure_ns;
}

}  // namespace cartvo::vo
