// Kanade-Lucas-Tomasi tracking of one patch: a shift, then an affine alignment.
#include "vo_core/thesis/klt.hpp"

#include <algorithm>

#include "vo_core/image/affine_alignment.hpp"
#include "vo_core/image/shift_tracking.hpp"

namespace cartvo::vo {
namespace {
constexpr double kMinimumShiftCorrelation =
    0.5;  // minimum correlation after the shift from which an affine alignment can still match
}  // namespace

KltResult trackPatch(const ImagePyramid& before, const ImagePyramid& after, const Eigen::Vector2d& from,
                     const Eigen::Vector2d& guess, int levels, const TrackingSettings& settings) {
  KltResult result;
  const auto shifted = trackShift({&before, &after, from, guess, {0, levels - 1}},
                                  std::min(kMinimumShiftCorrelation, settings.minimum_correlation));
  if (!shifted) return result;
  AffineAlignment start;
  start.position = *shifted;
  const auto aligned = alignAffine(before.grey.front(), after.grey.front(), from, start, settings.iterations,
                                   settings.convergence);
  if (!aligned) return result;
  result.position = aligned->position;
  result.correlation = aligned->correlation;
  result.found = result.correlation >= settings.minimum_correlation;
  return result;
}

}  // namespace cartvo::vo
