// Whether a track follows the world, or vehicles or a part of the cart in the view.
#include <algorithm>
#include <cmath>
#include <utility>

#include "vo_core/fixed_constants.hpp"
#include "vo_core/geometry/plausible_motion.hpp"
#include "vo_core/track/visual_track.hpp"

namespace cartvo::vo {

bool VisualTrack::isEstablished() const {
  return log_odds_ >= track_start::kEstablished;
}

/// Finds another pose that explains more than half as much as the pose found does, without what fits both, if
/// the pose found rests on landmarks that keep their place in the image, as on a part of the cart.
std::optional<AlternativePose> VisualTrack::findLikelyAlternative() {
  if (countStillInliers(pose_problem_) == 0) return std::nullopt;
  SubsetRandom random(settings_.seed);  // not random_: the check must not change any motion
  auto other = pose_finder_.findAlternative(pose_problem_, settings_.pose_search,
                                            settings_.validity.minimum_inliers, random);
  if (!other || other->weight <= kMajority * other->weight_of_found) return std::nullopt;
  if (other->still_of_found <= kMajority * other->weight_of_found) return std::nullopt;
  return other;
}

/// Whether the landmarks may as well show another pose. Of a first motion nothing but their number tells.
/// Later the cart must be able to make the other motion since the last pair without an alternative: a
/// standstill hides a slow departure at first.
bool VisualTrack::isAmbiguous(const PreparedPair& pair, const FoundPose& found, TrackedMotion& motion) {
  if (!isEstablished()) {
    const auto other = measureOdds(found, motion);
    const bool is_weak = !velocity_ && found.inlier_ratio < kUnambiguousShare;
    if (is_weak && other && other->weight > kMajority * other->weight_of_found) return true;
  }
  const auto other = findLikelyAlternative();
  if (!other) {
    unambiguous_ns_ = pair.left_exposure_ns;
    return false;
  }
  const double step = 1e-9 * static_cast<double>(pair.left_exposure_ns - unambiguous_ns_);
  const Vector6d change = vectorFromMotion(pose_problem_.expected.inverse() * other->T_world_camera);
  return !velocity_ || canStop(change / step, step);
}

/// Sets the odds of the pose found: its inliers against all outliers, or, if these show no other pose,
/// against fewer than such a one needs. With another pose, and less than two thirds of the weight, the odds
/// begin anew. Returns the other pose, whatever the cart can do.
std::optional<AlternativePose> VisualTrack::measureOdds(const FoundPose& found, TrackedMotion& motion) {
  SubsetRandom random(settings_.seed);
  const int needed = settings_.validity.minimum_inliers;
  const std::optional<Vector6d> gate = std::exchange(pose_problem_.admissible_change, std::nullopt);
  auto other = pose_finder_.findAlternative(pose_problem_, settings_.pose_search, needed, random);
  pose_problem_.admissible_change = gate;
  const int outliers = static_cast<int>(chosen_.size()) - found.inliers;
  const int against = other ? outliers : std::min(outliers, needed);
  motion.log_odds = std::log(static_cast<double>(found.inliers) / std::max(against, 1));
  if (other && found.inlier_ratio < kUnambiguousShare) log_odds_ = motion.log_odds = 0.0;
  return other;
}

/// Until the track is established, adds to the covariances that the cart may have any speed, with the
/// probability that the landmarks are not those of the world. The odds of pairs count as independent.
void VisualTrack::addStartUncertainty(TrackedMotion& motion) {
  if (isEstablished()) return;
  log_odds_ += motion.log_odds;
  if (isEstablished()) return;
  const double probability = 1.0 / (1.0 + std::exp(log_odds_));
  const double variance = probability * track_start::kSpeed * track_start::kSpeed;
  motion.by_start.diagonal().array() += variance * motion.time_step * motion.time_step;
  motion.twist->covariance.diagonal().array() += variance;
}

}  // namespace cartvo::vo
