// Reinitialisation of the rig's pitch when stereo matches are missing.
#include "vo_core/self_calibration/pitch_reinitialiser.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "common/statistics.hpp"
#include "vo_core/fixed_constants.hpp"

namespace cartvo::vo {
namespace {

// In the dark, patches correlate badly, but those that are unique agree.
constexpr PatchDemands kAnyPatch{.texture = 0.0, .correlation = 0.0};

bool hasFewMatches(const std::vector<Landmark>& landmarks) {
  return landmarks.size() >= pitch_search::kMinimumLandmarks &&
         static_cast<double>(countStereo(landmarks)) <
             pitch_search::kFewMatchesShare * static_cast<double>(landmarks.size());
}

/// Pitches of the right camera (rad) by the rows at which patches of the left image are found in the right
/// one. The rotation between the exposures is that of the poses, the parallax is taken as horizontal.
std::vector<double> pitchesOfPatches(const NewestPair& pair, const Eigen::Isometry3d& T_right_left,
                                     PatchSearch& search) {
  const StereoCamera& camera = pair.camera;
  const RowTransform right_from_left(camera, pair.timing, pair.window.back(), T_right_left);
  const std::vector<Eigen::Vector2i>& centres = search.choosePatches(pair.left);
  search.setSearched(pair.right, PatchSearch::kDisparityShare);
  std::vector<double> pitches;
  pitches.reserve(centres.size());
  for (const Eigen::Vector2i& centre : centres) {
    const Eigen::Vector2d left = search.fullPixel(centre);
    if (!pair.left.mask.allows(left, 0)) continue;
    const std::optional<Eigen::Vector2d> shift = search.find(pair.left, centre);
    if (!shift || !pair.right.mask.allows(left + *shift, 0)) continue;
    const Eigen::Vector3d turned = right_from_left.at(left).linear() * bearingOf(camera, left);
    const double expected = project(camera, turned).y();
    const double y = (expected - camera.cy) / camera.focal_length;
    pitches.push_back((left.y() + shift->y() - expected) / (camera.focal_length * (1.0 + y * y)));
  }
  return pitches;
}

/// The median, if at least half of the values are within `tolerance` of it, with the standard deviation of a
/// single value: patches share errors, which do not average out.
std::optional<EstimateWithStddev> agreedValue(std::vector<double> values, double tolerance) {
  const double agreed = median(values);
  for (double& value : values)
    value = std::abs(value - agreed);
  const double stddev = stddevFromMedian(values);
  if (kMedianOfNormal * stddev > tolerance) return std::nullopt;
  return EstimateWithStddev{agreed, stddev};
}

}  // namespace

PitchReinitialiser::PitchReinitialiser(const StereoCamera& camera, const SelfCalibrationSettings& settings,
                                       int levels)
    : settings_(settings), search_(camera.width, kAnyPatch, levels) {}

bool PitchReinitialiser::tryReinitialise(const NewestPair& pair, const Eigen::Isometry3d& T_right_left,
                                         const std::vector<Landmark>& landmarks, RigCalibration& rig) {
  const WindowFrame& newest = pair.window.back();
  if (newest.index < next_pair_ || !hasFewMatches(landmarks)) return false;
  next_pair_ = newest.index + pitch_search::kSearchInterval;
  std::vector<double> pitches = pitchesOfPatches(pair, T_right_left, search_);
  if (pitches.size() < pitch_search::kMinimumPatches) return false;
  const double pixel = 1.0 / pair.camera.focal_length;  // rad
  auto pitch = agreedValue(std::move(pitches), pitch_search::kRowTolerance * pixel);
  if (!pitch || std::abs(pitch->value) > pitch_search::kMaximumPitch) return false;
  if (std::abs(pitch->value - rig.expected().pitch) < pitch_search::kSearchedRows * pixel) return false;
  const double rate = pair.window.size() > 1 ? settings_.rate_stddev : settings_.unknown_rate_stddev;
  pitch->stddev = std::hypot(std::max(pitch->stddev, stereo_look::kRowNoise * pixel), rate * newest.offset);
  rig.reinitialisePitch(*pitch);
  return true;
}

}  // namespace cartvo::vo
