// Landmarks sorted by their hosts and laid side by side.
#include "vo_core/bundle_blocks.hpp"

#include <array>
#include <cmath>

namespace cartvo {

void BundleBlocks::take(const BundleProblem& problem) {
  order_.reserve(problem.landmarks.capacity());
  order_.sort(problem.poses.size(), problem.landmarks.size(),
              [&](std::size_t i) { return problem.landmarks[i].sightings.front().pose; });
  landmarks.clear();
  landmarks.reserve(order_.mostBlocks());
  sightings.clear();
  sightings.reserve(kMostWindowPairs * order_.mostBlocks());
  order_.forEachBlock([&](int host, const int* first, int count) { add(problem, host, first, count); });
}

void BundleBlocks::add(const BundleProblem& problem, int host, const int* first, int count) {
  LandmarkBlock& block = landmarks.emplace_back();
  block.host = host;
  block.count = count;
  block.first_sighting = sightings.size();
  std::array<int, kMostWindowPairs> slot;
  slot.fill(-1);
  for (int lane = 0; lane < count; ++lane)
    for (const BundleSighting& sighting : problem.landmarks[first[lane]].sightings)
      slot[sighting.pose] = 0;
  for (std::size_t pose = 0; pose < slot.size(); ++pose) {
    if (slot[pose] < 0) continue;
    slot[pose] = static_cast<int>(sightings.size());
    sightings.emplace_back().pose = static_cast<int>(pose);
  }
  block.last_sighting = sightings.size();

  block.place.bearing[2] = 1.0 + DoubleLanes{};
  for (int lane = 0; lane < count; ++lane) {
    const BundleLandmark& landmark = problem.landmarks[first[lane]];
    const BundleNoise& noise = problem.noise[landmark.level];
    block.landmark[lane] = first[lane];
    block.level[lane] = landmark.level;
    block.place.bearing[0][lane] = landmark.bearing.x();
    block.place.bearing[1][lane] = landmark.bearing.y();
    block.place.inverse_depth[lane] = landmark.inverse_depth;
    block.weight[lane] = landmark.weight;
    block.prior_inverse_depth[lane] = landmark.prior_inverse_depth;
    block.prior_information[lane] = landmark.prior_information;
    block.prior_by_late_right[lane] = landmark.prior_by_late_right;
    for (const BundleSighting& sighting : landmark.sightings) {
      SightingBlock& into = sightings[slot[sighting.pose]];
      into.seen[lane] = 1.0;
      into.stereo[lane] = sighting.stereo ? 1.0 : 0.0;
      into.disparity_precision[lane] =
          1.0 / (noise.disparity + noise.stretch * std::abs(sighting.disparity()));
      for (int axis = 0; axis < 2; ++axis) {
        into.position_precision[axis][lane] = 1.0 / (noise.pixel * sighting.relative_noise[axis]);
        into.left[axis][lane] = sighting.left[axis];
        into.right[axis][lane] = sighting.right[axis];
      }
    }
  }
}

}  // namespace cartvo
