// Detection of a frozen left camera by the right camera's motion.
#include "vo_core/integrity/frozen_camera_detector.hpp"

#include "vo_core/estimation/window_problems.hpp"
#include "vo_core/geometry/subset_random.hpp"

namespace cartvo::vo {
namespace {

// Factor on the standstill limits of the left camera: a pose by right positions and depths has the noise of
// both. On rendered standstills, lossless and at 2 Mbit/s, it varied by at most 1.2 mm and 0.2 mrad.
constexpr double kLimitFactor = 3.0;
// Minimum share of the landmarks that localised the right camera at the start. In an image of another place
// some match by chance, all of them near the expected pose; on rendered standstills at least three quarters
// of the left camera's landmarks match.
constexpr double kMinimumLandmarkShare = 0.25;

}  // namespace

FrozenCameraDetector::FrozenCameraDetector(const StereoCamera& camera, const OdometrySettings& settings)
    : camera_(camera), settings_(settings) {}

void FrozenCameraDetector::reset() {
  start_.reset();
  left_is_frozen_ = false;
}

void FrozenCameraDetector::update(const Pair& pair, const Before& before, std::vector<Landmark>& landmarks,
                                  const Work& work) {
  setUpProblem(pair, before, work.problem);
  if (!start_) {
    const auto displacement = localiseRight(before.window, before.landmarks, pair.rig, work);
    if (!displacement) return;  // no right-camera pose: cannot cross-check
    start_ = startAt(*displacement, before.window.back().exposure_ns);
    start_->limits.translation += pair.translation_slack;
    start_->limits.rotation += pair.rotation_slack;
  }
  const std::vector<WindowFrame>& window = pair.images.window;
  matchStereoRotated(pair.images, newestRightFromLeft(timedPoses(window), camera_.baseline), pair.rig,
                     landmarks);
  const auto displacement = localiseRight(window, landmarks, pair.rig, work);
  if (displacement && displacement->landmarks >= kMinimumLandmarkShare * start_->displacement.landmarks)
    compare(startAt(*displacement, pair.exposure_ns));
  else
    handleLoss(pair);
}

/// Sets what is the same for the pair and the previous one: no landmark's anchor is later than that one.
void FrozenCameraDetector::setUpProblem(const Pair& pair, const Before& before, PoseProblem& problem) const {
  problem.camera = camera_;
  problem.noise = pair.noise;
  problem.admissible_change = pair.admissible_change;
  problem.anchors.clear();
  for (const WindowFrame& frame : before.window)
    problem.anchors.push_back(frame.T_world_camera);
}

/// Localises the right camera of the last pair by its own image; empty if that fails.
std::optional<FrozenCameraDetector::Displacement> FrozenCameraDetector::localiseRight(
    const std::vector<WindowFrame>& window, const std::vector<Landmark>& landmarks,
    const RigCalibrationFilter& rig, const Work& work) const {
  auto& [problem, chosen, finder] = work;
  problem.start =
      window.back().T_world_camera * newestRightFromLeft(timedPoses(window), camera_.baseline).inverse();
  problem.expected = problem.start;
  toPosePoints(landmarks, window, camera_, problem.points, chosen);
  toRightCameraPoints(landmarks, chosen, camera_, rig.correction(), problem.points);
  if (static_cast<int>(problem.points.size()) < settings_.validity.minimum_matches) return std::nullopt;

  SubsetRandom random(settings_.seed);  // not the track's: the detector must not change its motions
  const auto found = finder.find(problem, settings_.pose_search, random);
  if (!found || !hasEnoughInliers(*found, settings_.validity)) return std::nullopt;
  return Displacement{problem.start.inverse() * found->T_world_camera, found->inliers};
}

/// The right camera cannot be localised. The cause may be glare or a bus, unless the left image repeats.
void FrozenCameraDetector::handleLoss(const Pair& pair) {
  left_is_frozen_ = left_is_frozen_ || pair.left_repeats;
  if (left_is_frozen_) start_->since_ns = pair.exposure_ns;
}

FrozenCameraDetector::Start FrozenCameraDetector::startAt(const Displacement& displacement,
                                                          std::int64_t exposure_ns) const {
  StandstillSettings limits = settings_.standstill;
  limits.translation *= kLimitFactor;
  limits.rotation *= kLimitFactor;
  return {displacement, exposure_ns, limits};
}

void FrozenCameraDetector::compare(const Start& now) {
  const bool moved = StandstillDetector(start_->limits)
                         .exceedsLimits(start_->displacement.motion.inverse() * now.displacement.motion);
  if (moved) {
    const int landmarks = start_->displacement.landmarks;  // kept: their number falls with each pair
    start_ = now;
    start_->displacement.landmarks = landmarks;
  }
  left_is_frozen_ = left_is_frozen_ || moved;
  if (1e-9 * static_cast<double>(now.since_ns - start_->since_ns) < settings_.standstill.least_time) return;
  // The right camera stands at this place: extrapolations from before the stop no longer apply.
  start_ = now;
  left_is_frozen_ = false;
}

}  // namespace cartvo::vo
