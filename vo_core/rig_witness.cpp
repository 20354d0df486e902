// A second adjustment of a track's window, for the rig's sake.
#include "vo_core/rig_witness.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vo_core/bundle_noise.hpp"
#include "vo_core/median.hpp"
#include "vo_core/triangulation.hpp"
#include "vo_core/window_problems.hpp"

namespace cartvo {
namespace {

constexpr int kPairs = 10;               // of which the last is heard
constexpr std::size_t kLandmarks = 300;  // that are enough, about
constexpr std::size_t kFewest = 30;      // matched landmarks that fix the window's scale
constexpr std::size_t kFewestHosted =
    20;                                  // landmarks by which a pair's pose is known against the first one's
constexpr double kForgivenRow = 1.0;     // px that a match may be off its row, and the track still finds it
constexpr double kForgivenColumn = 1.0;  // px, so far beyond infinity

/// The first pair of the window from which so many landmarks have been followed that the next one's pose is
/// known against it. There must be as many.
std::int64_t firstHost(const std::vector<Landmark>& landmarks) {
  std::vector<std::int64_t> hosts;
  hosts.reserve(landmarks.size());
  for (const Landmark& landmark : landmarks)
    hosts.push_back(landmark.host().frame);
  const auto at = hosts.begin() + static_cast<std::ptrdiff_t>(kFewestHosted);
  std::nth_element(hosts.begin(), at, hosts.end());
  return *at;
}

/// By how much the newest pair's corrected matches say that inverse depths are larger than the track has
/// them. Nothing if there are too few.
std::optional<double> scaleByMatches(const StereoCamera& camera, const std::vector<WindowFrame>& window,
                                     const std::vector<Landmark>& landmarks, const RigCorrection& rig) {
  const Eigen::Isometry3d T_right_left = newestRightFromLeft(timedPoses(window), camera.baseline);
  std::vector<double> ratios;
  for (const Landmark& landmark : landmarks) {
    const Sighting& last = landmark.last();
    const WindowFrame* host = findFrame(window, landmark.host().frame);
    if (!last.stereo || host == nullptr) continue;
    const Projection seen =
        projectLandmark(camera, window.back().T_world_camera.inverse() * host->T_world_camera,
                        bearingOf(camera, landmark.host().left), landmark.inverse_depth);
    const auto found =
        triangulate(camera, T_right_left, last.left, correctedRight(camera, rig, last.left - last.parallax));
    if (!seen.valid || !found) continue;
    const double ratio = found->inverse_depth * seen.ray.z() / landmark.inverse_depth;
    if (std::isfinite(ratio) && ratio > 0.0) ratios.push_back(ratio);
  }
  if (ratios.size() < kFewest) return std::nullopt;
  return median(ratios);
}

/// The whole world made smaller by so much, about the first pair.
void shrink(BundleProblem& problem, double by) {
  const Eigen::Vector3d origin = problem.poses.front().T_world_camera.translation();
  for (TimedPose& pose : problem.poses) {
    auto place = pose.T_world_camera.translation();
    place = origin + (place - origin) / by;
  }
  for (BundleLandmark& landmark : problem.landmarks)
    landmark.inverse_depth *= by;
}

/// Some of those that have a depth and were seen by more than one pair, in the order in which they are.
std::vector<Landmark> chosenOf(const std::vector<Landmark>& landmarks) {
  std::vector<const Landmark*> followed;
  for (const Landmark& landmark : landmarks)
    if (landmark.hasDepth() && landmark.sightings.size() > 1) followed.push_back(&landmark);
  const std::size_t stride = std::max<std::size_t>(1, (followed.size() + kLandmarks / 2) / kLandmarks);
  std::vector<Landmark> chosen;
  for (std::size_t i = 0; i < followed.size(); i += stride)
    chosen.push_back(*followed[i]);
  return chosen;
}

}  // namespace

/// Whether the track looks for matches in rows where they are not.
bool RigWitness::hidesMatches(const RigMonitor& rig) const {
  const RigCorrection expected = rig.expected();
  return camera_.focal_length * std::abs(expected.pitch) + 0.5 * camera_.width * std::abs(expected.roll) >
         kForgivenRow;
}

/// Whether the track looks for what is far where it is not: a right camera that looks too far to the left
/// shows it at disparities below zero, and the track takes nothing to be beyond infinity.
bool RigWitness::hidesTheFar(const RigMonitor& rig) const {
  return camera_.focal_length * -rig.expected().yaw > kForgivenColumn;
}

/// Wherever the matches may be; depths stay as a start for what follows.
void RigWitness::matchAnew(const NewestPair& pair, const RigMonitor& rig,
                           std::vector<Landmark>& landmarks) const {
  std::vector<Landmark> sought = landmarks;
  forgetStereoAndDepth(sought);
  matchTurned(pair, newestRightFromLeft(timedPoses(pair.window), camera_.baseline), rig, sought);
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    landmarks[i].sightings = sought[i].sightings;
}

/// Where the track's depths lead once they have the scale of the matches there are. The track's own matches
/// of what is far were looked for some pixels off: they are lost or, in the dark, found too near to there, so
/// that a sixth of the yaw was missing.
void RigWitness::matchByDepth(const NewestPair& pair, const RigMonitor& rig,
                              std::vector<Landmark>& landmarks) const {
  const auto scale = scaleByMatches(camera_, pair.window, landmarks, rig.correction());
  if (!scale) return;
  forgetStereo(landmarks);
  const double baseline = *scale * camera_.baseline;  // in the metres of the track
  matchTurned(pair, newestRightFromLeft(timedPoses(pair.window), baseline), rig, landmarks);
}

/// The window by itself: all poses but the first are free, and nothing is held against depths that earlier
/// pairs, uncorrected, knew.
BundleProblem RigWitness::problemOf(const NewestPair& pair, const std::vector<Landmark>& landmarks,
                                    const RigCorrection& rig) const {
  const std::int64_t first = firstHost(landmarks);
  std::vector<WindowFrame> window = pair.window;
  std::erase_if(window, [&](const WindowFrame& frame) { return frame.index < first; });
  std::vector<Landmark> hosted = landmarks;
  std::erase_if(hosted, [&](const Landmark& landmark) { return landmark.host().frame < first; });
  std::vector<std::size_t> chosen;
  BundleProblem problem;
  problem.camera = camera_;
  problem.noise = noise_;
  problem.poses = timedPoses(window);
  problem.fixed = 1;
  takeLandmarks(hosted, window, camera_, rig, problem.landmarks, chosen);
  for (BundleLandmark& landmark : problem.landmarks)
    landmark.prior_information = 0.0;
  return problem;
}

void RigWitness::take(const NewestPair& pair, const std::vector<Landmark>& all, RigMonitor& rig) {
  if (++pairs_ < kPairs) return;
  pairs_ = 0;
  std::vector<Landmark> landmarks = chosenOf(all);
  if (hidesMatches(rig))
    matchAnew(pair, rig, landmarks);
  else if (hidesTheFar(rig))
    matchByDepth(pair, rig, landmarks);
  const RigCorrection known = rig.correction();
  const auto scale = scaleByMatches(camera_, pair.window, landmarks, known);
  if (!scale) return;
  BundleProblem problem = problemOf(pair, landmarks, known);
  shrink(problem, *scale);
  const BundleResult result = adjustBundle(problem, settings_.bundle);
  if (!result.converged) return;
  const EvidenceSpan span{1e-9 * static_cast<double>(pair.window.back().exposure_ns - heard_ns_), kPairs};
  rig.add(problem, result, rowEvidence(problem), known, span);
  noise_ = adapted(noise_, result, kPairs);
  heard_ns_ = pair.window.back().exposure_ns;
}

}  // namespace cartvo
