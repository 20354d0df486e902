// Sorting of landmarks by anchor and copying into SIMD blocks.
#include "vo_core/estimation/bundle_blocks.hpp"

#include <array>
#include <cmath>

namespace cartvo::vo {

void BundleBlocks::reset(const BundleProblem& problem) {
  order_.reserve(problem.landmarks.capacity());
  order_.sort(problem.poses.size(), problem.landmarks.size(),
              [&](std::size_t i) { return problem.landmarks[i].observations.front().pose; });
  landmarks.clear();
  landmarks.reserve(order_.maximumBlocks());
  observations.clear();
  observations.reserve(kMaximumWindowPairs * order_.maximumBlocks());
  order_.forEachBlock([&](int anchor, const int* first, int count) { add(problem, anchor, first, count); });
}

void BundleBlocks::add(const BundleProblem& problem, int anchor, const int* first, int count) {
  LandmarkBlock& block = landmarks.emplace_back();
  block.anchor = anchor;
  block.count = count;
  block.first_observation = observations.size();
  std::array<int, kMaximumWindowPairs> slot;
  slot.fill(-1);
  for (int lane = 0; lane < count; ++lane)
    for (const BundleObservation& observation : problem.landmarks[first[lane]].observations)
      slot[observation.pose] = 0;
  for (std::size_t pose = 0; pose < slot.size(); ++pose) {
    if (slot[pose] < 0) continue;
    slot[pose] = static_cast<int>(observations.size());
    observations.emplace_back().pose = static_cast<int>(pose);
  }
  block.last_observation = observations.size();

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
    block.prior_dinverse_depth_doffset[lane] = landmark.prior_dinverse_depth_doffset;
    for (const BundleObservation& observation : landmark.observations) {
      ObservationBlock& into = observations[slot[observation.pose]];
      into.seen[lane] = 1.0;
      into.stereo[lane] = observation.stereo ? 1.0 : 0.0;
      into.disparity_precision[lane] =
          1.0 / (noise.disparity + noise.stretch * std::abs(observation.disparity()));
      for (int axis = 0; axis < 2; ++axis) {
        into.position_precision[axis][lane] = 1.0 / (noise.pixel * observation.relative_noise[axis]);
        into.left[axis][lane] = observation.left[axis];
        into.right[axis][lane] = observation.right[axis];
      }
    }
  }
}

}  // namespace cartvo::vo
