// Noise of landmark positions and rejection of stereo matches by their rows.
#include "vo_core/tracking/landmark.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/statistics.hpp"
#include "vo_core/image/image_pyramid.hpp"

namespace cartvo::vo {
namespace {

// Minimum stddev of a position, that of the steepest patch, in single and in inter-coded images. Fitted on
// rendered worlds and kitti_06 (docs/accuracy.md).
constexpr double kMinimumPatchNoise = 0.07, kMinimumCodecNoise = 0.12;  // px of the level
constexpr double kTypicalNoise = 0.1;  // px of the full image: stddev of a typical patch

}  // namespace

LandmarkView viewOf(const Landmark& landmark, std::int64_t previous) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  const Observation& seen = landmark.last();
  const Eigen::Vector2f left = seen.left.cast<float>();
  const Eigen::Vector2f right =
      seen.stereo ? Eigen::Vector2f(seen.right().cast<float>()) : Eigen::Vector2f::Constant(kUnknown);
  const Observation* const before = landmark.find(previous);
  const Eigen::Vector2f previous_left =
      before != nullptr ? Eigen::Vector2f(before->left.cast<float>()) : Eigen::Vector2f::Constant(kUnknown);
  return {.left_x = left.x(),
          .left_y = left.y(),
          .right_x = right.x(),
          .right_y = right.y(),
          .previous_x = previous_left.x(),
          .previous_y = previous_left.y(),
          .weight = static_cast<float>(landmark.trust),
          .age = landmark.age,
          .inverse_depth = landmark.hasDepth() ? static_cast<float>(landmark.inverse_depth) : kUnknown};
}

int countStereo(const std::vector<Landmark>& landmarks) {
  return static_cast<int>(std::count_if(landmarks.begin(), landmarks.end(),
                                        [](const Landmark& landmark) { return landmark.last().stereo; }));
}

int countWithDepth(const std::vector<Landmark>& landmarks) {
  return static_cast<int>(std::count_if(landmarks.begin(), landmarks.end(),
                                        [](const Landmark& landmark) { return landmark.hasDepth(); }));
}

Eigen::Vector2d relativeNoise(const Eigen::Vector2d& variance, int level) {
  const double floor = kMinimumPatchNoise * levelScale(level);
  return (variance.array() + floor * floor).sqrt() / kTypicalNoise;
}

void inflateCodecNoise(std::vector<Landmark>& landmarks) {
  constexpr double kAddedVariance =
      (kMinimumCodecNoise * kMinimumCodecNoise - kMinimumPatchNoise * kMinimumPatchNoise) /
      (kTypicalNoise * kTypicalNoise);
  for (Landmark& landmark : landmarks) {
    const double scale = levelScale(landmark.level);
    auto noise = landmark.observations.back().relative_noise.array();
    noise = (noise.square() + kAddedVariance * scale * scale).sqrt();
  }
}

void rejectRowOutliers(std::vector<Landmark>& landmarks, std::vector<double>& rows) {
  constexpr double kMinimumGate = 0.5;    // px of the level
  constexpr double kGateInStddevs = 2.0;  // for rows that all scatter, as those of a rolled rig
  rows.clear();
  rows.reserve(landmarks.capacity());
  for (const Landmark& landmark : landmarks)
    if (landmark.last().stereo) rows.push_back(landmark.row_residual);
  if (rows.empty()) return;
  const double common = median(rows);  // nonzero if the rig has a pitch error
  for (double& row : rows)
    row = std::abs(row - common);
  const double gate = std::max(kMinimumGate, kGateInStddevs * stddevFromMedian(rows));
  for (Landmark& landmark : landmarks)
    if (std::abs(landmark.row_residual - common) > gate * levelScale(landmark.level))
      landmark.observations.back().stereo = false;
}

void discardLastStereo(std::vector<Landmark>& landmarks) {
  for (Landmark& landmark : landmarks)
    landmark.observations.back().stereo = false;
}

}  // namespace cartvo::vo
