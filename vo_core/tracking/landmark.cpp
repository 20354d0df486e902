// Counts, noise and views of landmarks.
#include "vo_core/tracking/landmark.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vo_core/image/image_pyramid.hpp"

namespace cartvo::vo {
namespace {

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
          .weight = static_cast<float>(landmark.weight),
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

Eigen::Vector2d relativeNoise(const Eigen::Vector2d& variance, int level, const TrackingSettings& settings) {
  const double floor = settings.minimum_patch_noise * levelScale(level);
  return (variance.array() + floor * floor).sqrt() / kTypicalNoise;
}

void inflateCodecNoise(std::vector<Landmark>& landmarks, const TrackingSettings& settings) {
  const double codec = settings.minimum_codec_noise, patch = settings.minimum_patch_noise;
  const double added_variance = (codec * codec - patch * patch) / (kTypicalNoise * kTypicalNoise);
  for (Landmark& landmark : landmarks) {
    const double scale = levelScale(landmark.level);
    auto noise = landmark.observations.back().relative_noise.array();
    noise = (noise.square() + added_variance * scale * scale).sqrt();
  }
}

void discardLastStereo(std::vector<Landmark>& landmarks) {
  for (Landmark& landmark : landmarks)
    landmark.observations.back().stereo = false;
}

}  // namespace cartvo::vo
