// Mean patch overlap: inflates the covariance for pixel noise that landmarks share.
#include "vo_core/estimation/patch_overlap.hpp"

#include <algorithm>
#include <cmath>

#include "vo_core/image/affine_alignment.hpp"

namespace cartvo::vo {
namespace {

constexpr int kMaximumSampledPatches = 250;  // per level; larger sets are subsampled

/// Intersection area of two squares of side 1 with these centres.
double sharedArea(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d apart = (a - b).cwiseAbs();
  return std::max(1.0 - apart.x(), 0.0) * std::max(1.0 - apart.y(), 0.0);
}

}  // namespace

/// Cell in a grid with a ring of empty cells around the image. Patches outside the image get the nearest
/// inner cell.
std::size_t PatchOverlap::cellOf(const Patch& patch) const {
  const int column = std::clamp(static_cast<int>(patch.centre.x()) + 1, 1, columns_ - 2);
  const int row = std::clamp(static_cast<int>(patch.centre.y()) + 1, 1, rows_ - 2);
  return static_cast<std::size_t>(row) * columns_ + column;
}

double PatchOverlap::overlapOf(const Patch& patch) const {
  const std::size_t cell = cellOf(patch);
  double sum = 0.0;
  for (const std::size_t middle : {cell - columns_, cell, cell + columns_})
    for (int place = by_cell_.begin(middle - 1); place < by_cell_.begin(middle + 2); ++place)
      sum += sharedArea(patch.centre, patches_[by_cell_[place]].centre);
  return sum;
}

PatchOverlap::Sums PatchOverlap::sumsOf(const BundleProblem& problem, int level) {
  const double side = kPatchSide * levelScale(level);
  const double precision = 1.0 / (problem.noise[level].pixel * problem.noise[level].pixel);
  patches_.clear();
  patches_.reserve(problem.landmarks.capacity());
  by_cell_.reserve(problem.landmarks.capacity());
  for (const BundleLandmark& landmark : problem.landmarks) {
    const BundleObservation& last = landmark.observations.back();
    if (landmark.level == level && last.pose + 1 == static_cast<int>(problem.poses.size()))
      patches_.push_back({last.left / side, landmark.weight * precision});
  }
  columns_ = static_cast<int>(problem.camera.width / side) + 3;
  rows_ = static_cast<int>(problem.camera.height / side) + 3;
  by_cell_.sort(static_cast<std::size_t>(columns_) * rows_, patches_.size(),
                [&](std::size_t i) { return cellOf(patches_[i]); });
  Sums sums;
  double sampled_information = 0.0;
  const int count = static_cast<int>(patches_.size());
  const int step = (count + kMaximumSampledPatches - 1) / kMaximumSampledPatches;
  for (int place = 0; place < count; ++place) {
    const Patch& patch = patches_[by_cell_[place]];
    sums.information += patch.information;
    if (place % step != 0) continue;
    sampled_information += patch.information;
    sums.overlap += patch.information * overlapOf(patch);
  }
  if (sampled_information > 0.0) sums.overlap *= sums.information / sampled_information;
  return sums;
}

double PatchOverlap::compute(const BundleProblem& problem) {
  Sums all;
  for (int level = 0; level < kLandmarkLevels; ++level) {
    const Sums sums = sumsOf(problem, level);
    all.information += sums.information;
    all.overlap += sums.overlap;
  }
  return all.information > 0.0 ? all.overlap / all.information : 1.0;
}

}  // namespace cartvo::vo
