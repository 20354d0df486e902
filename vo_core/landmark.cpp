#include "vo_core/landmark.hpp"

#include <algorithm>
#include <cmath>

#include "vo_core/image_pyramid.hpp"
#include "vo_core/median.hpp"

namespace cartvo {
namespace {

// Least noise of a position, that of the steepest patch, in images and in a video. Found on rendered worlds
// and kitti_06 (docs/accuracy.md).
constexpr double kPatchFloor = 0.07, kVideoFloor = 0.12;  // px of the level
constexpr double kTypicalNoise = 0.1;                     // px of the image: a relative noise of one

}  // namespace

int countStereo(const std::vector<Landmark>& landmarks) {
  return static_cast<int>(std::count_if(landmarks.begin(), landmarks.end(),
                                        [](const Landmark& landmark) { return landmark.last().stereo; }));
}

Eigen::Vector2d relativeNoise(const Eigen::Vector2d& variance, int level) {
  const double floor = kPatchFloor * levelScale(level);
  return (variance.array() + floor * floor).sqrt() / kTypicalNoise;
}

void doubtLastPositions(std::vector<Landmark>& landmarks) {
  constexpr double kMore =
      (kVideoFloor * kVideoFloor - kPatchFloor * kPatchFloor) / (kTypicalNoise * kTypicalNoise);
  for (Landmark& landmark : landmarks) {
    const double scale = levelScale(landmark.level);
    auto noise = landmark.sightings.back().relative_noise.array();
    noise = (noise.square() + kMore * scale * scale).sqrt();
  }
}

void forgetOffRows(std::vector<Landmark>& landmarks, std::vector<double>& rows) {
  constexpr double kOffRow = 0.5;    // px of the level
  constexpr double kScatters = 2.0;  // standard deviations of rows that all scatter, as a rolled rig's do
  rows.clear();
  rows.reserve(landmarks.capacity());
  for (const Landmark& landmark : landmarks)
    if (landmark.last().stereo) rows.push_back(landmark.row_miss);
  if (rows.empty()) return;
  const double common = median(rows);  // of a rig that is turned up or down
  for (double& row : rows)
    row = std::abs(row - common);
  const double most = std::max(kOffRow, kScatters * deviationOf(rows));
  for (Landmark& landmark : landmarks)
    if (std::abs(landmark.row_miss - common) > most * levelScale(landmark.level))
      landmark.sightings.back().stereo = false;
}

void forgetLastStereo(std::vector<Landmark>& landmarks) {
  for (Landmark& landmark : landmarks)
    landmark.sightings.back().stereo = false;
}

}  // namespace cartvo
