#include "vo_core/stand_witness.hpp"

#include "vo_core/subset_random.hpp"
#include "vo_core/window_problems.hpp"

namespace cartvo {
namespace {

// Times what a standing cart's left camera may stray: a pose by right positions and depths has the noise of
// both. On rendered stands, lossless and of 2 Mbit/s, it strayed by 1.2 mm and 0.2 mrad at most.
constexpr double kWider = 3.0;
// Of the landmarks that said where it was. Where a picture is looked for in vain, some are found by chance,
// all of them about where they were expected; on rendered stands three quarters of the left camera's are, at
// least.
constexpr double kLeastSeen = 0.25;

}  // namespace

StandWitness::StandWitness(const StereoCamera& camera, const OdometrySettings& settings)
    : camera_(camera), settings_(settings) {}

void StandWitness::forget() {
  stay_.reset();
  denies_ = false;
}

void StandWitness::hear(const Pair& pair, const Before& before, std::vector<Landmark>& landmarks,
                        const Work& work) {
  state(pair, before, work.problem);
  if (!stay_) {
    const auto stray = strayOfRight(before.window, before.landmarks, pair.rig, work);
    if (!stray) return;  // of a right camera that tells no pose nothing can be heard
    stay_ = stayAt(*stray, before.window.back().exposure_ns);
    stay_->limits.translation += pair.translation_slack;
    stay_->limits.rotation += pair.rotation_slack;
  }
  const std::vector<WindowFrame>& window = pair.images.window;
  matchTurned(pair.images, newestRightFromLeft(timedPoses(window), camera_.baseline), pair.rig, landmarks);
  const auto stray = strayOfRight(window, landmarks, pair.rig, work);
  if (stray && stray->landmarks >= kLeastSeen * stay_->stray.landmarks)
    note(stayAt(*stray, pair.exposure_ns));
  else
    miss(pair);
}

/// What is the same for the pair and the one before: no landmark's host is later than that one.
void StandWitness::state(const Pair& pair, const Before& before, PoseProblem& problem) const {
  problem.camera = camera_;
  problem.noise = pair.noise;
  problem.admissible_change = pair.admissible_change;
  problem.hosts.clear();
  for (const WindowFrame& frame : before.window)
    problem.hosts.push_back(frame.T_world_camera);
}

/// Of the last pair, by its right picture alone; nothing if that does not tell.
std::optional<StandWitness::Stray> StandWitness::strayOfRight(const std::vector<WindowFrame>& window,
                                                              const std::vector<Landmark>& landmarks,
                                                              const RigMonitor& rig, const Work& work) const {
  auto& [problem, chosen, finder] = work;
  problem.start =
      window.back().T_world_camera * newestRightFromLeft(timedPoses(window), camera_.baseline).inverse();
  takePoints(landmarks, window, camera_, problem.points, chosen);
  seeByRight(landmarks, chosen, camera_, rig.correction(), problem.points);
  if (static_cast<int>(problem.points.size()) < settings_.validity.minimum_matches) return std::nullopt;

  SubsetRandom random(settings_.seed);  // its own: what is asked here changes no motion
  const auto found = finder.find(problem, settings_.pose_search, random);
  if (!found || !enoughAgree(*found, settings_.validity)) return std::nullopt;
  return Stray{problem.start.inverse() * found->T_world_camera, found->inliers};
}

/// The right picture tells nothing. It may be glare or a bus, unless the left one hangs.
void StandWitness::miss(const Pair& pair) {
  denies_ = denies_ || pair.left_repeats;
  if (denies_) stay_->since_ns = pair.exposure_ns;
}

StandWitness::Stay StandWitness::stayAt(const Stray& stray, std::int64_t exposure_ns) const {
  StandstillSettings limits = settings_.standstill;
  limits.translation *= kWider;
  limits.rotation *= kWider;
  return {stray, exposure_ns, limits};
}

void StandWitness::note(const Stay& now) {
  const bool leaves =
      StandstillDetector(stay_->limits).beyond(stay_->stray.motion.inverse() * now.stray.motion);
  if (leaves) {
    const int landmarks = stay_->stray.landmarks;  // which fewer and fewer of are found again
    stay_ = now;
    stay_->stray.landmarks = landmarks;
  }
  denies_ = denies_ || leaves;
  if (1e-9 * static_cast<double>(now.since_ns - stay_->since_ns) < settings_.standstill.least_time) return;
  // It has been at rest for as long: what was foretold in motion is over.
  stay_ = now;
  denies_ = false;
}

}  // namespace cartvo
