// Pyramidal Kanade-Lucas-Tomasi tracking of one patch.
#include "vo_core/klt.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "vo_core/affine_alignment.hpp"
#include "vo_core/patch.hpp"

namespace cartvo {
namespace {

constexpr int kSide = 15;                // px
constexpr double kMinimumTexture = 1.0;  // grey^2 / px^2, smaller eigenvalue of G per pixel
constexpr int kShiftIterations = 5;      // a shift that takes longer is lost
constexpr double kWorthAligning = 0.5;   // correlation after the shift, of which a warp may make a match
constexpr double kCoarse = 0.1;          // px: precise enough for a shift that will be refined
using Template = Patch<kSide, kSide>;

/// The patch before, its gradients (mean removed, which makes the shift blind to a change of brightness) and
/// the inverse of its structure matrix G (thesis 4.12). All zero in the padding.
struct Linearisation {
  Template grey;
  Template gradient_x;
  Template gradient_y;
  Eigen::Matrix2d inverse_structure;
  double smaller_eigenvalue = 0.0;  ///< of G, per pixel
};

void linearise(const PyramidLevel& level, const Eigen::Vector2d& centre, Linearisation& out) {
  sampleGradients(level, centre, out.grey, out.gradient_x, out.gradient_y);
  removeMean(out.grey);
  removeMean(out.gradient_x);
  removeMean(out.gradient_y);

  const double xx = sumOfProducts(out.gradient_x, out.gradient_x);
  const double xy = sumOfProducts(out.gradient_x, out.gradient_y);
  const double yy = sumOfProducts(out.gradient_y, out.gradient_y);
  out.smaller_eigenvalue =
      (0.5 * (xx + yy) - std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy)) / Template::kSize;
  const double determinant = xx * yy - xy * xy;
  if (determinant > 0.0)
    out.inverse_structure << yy / determinant, -xy / determinant, -xy / determinant, xx / determinant;
}

/// The mismatch vector b (thesis 4.13).
Eigen::Vector2d mismatch(const Linearisation& before, const Template& after) {
  Lanes x{}, y{};
  for (int row = 0; row < kSide; ++row) {
    for (int block = 0; block < Template::kBlocks; ++block) {
      const Lanes difference = after.lanes(row, block) - before.grey.lanes(row, block);
      x += before.gradient_x.lanes(row, block) * difference;
      y += before.gradient_y.lanes(row, block) * difference;
    }
  }
  return {sumOf(x), sumOf(y)};
}

double correlationOf(const Template& centred_before, Template& after) {
  removeMean(after);
  const double squares = sumOfProducts(centred_before, centred_before) * sumOfProducts(after, after);
  return sumOfProducts(centred_before, after) / std::sqrt(std::max(squares, 1e-12));
}

}  // namespace

CARTVO_VECTOR_CLONES
std::optional<Eigen::Vector2d> trackShift(const ImagePyramid& before, const ImagePyramid& after,
                                          const Eigen::Vector2d& from, const Eigen::Vector2d& guess,
                                          const PyramidLevels& levels, double minimum_correlation) {
  if (!before.grey.front().contains(from)) return std::nullopt;
  Linearisation patch;
  Template moved;
  Eigen::Vector2d shift = guess - from;  // px of the full image
  const int available = static_cast<int>(std::min(before.grey.size(), after.grey.size()));
  for (int index = std::min(levels.coarsest, available - 1); index >= levels.finest; --index) {
    const bool finest = index == levels.finest;
    const double scale = 1.0 / (1 << index);
    const PyramidLevel& target = after.grey[index];
    const Eigen::Vector2d centre = from * scale;
    // In a small level the centre of a pixel near the right or lower edge may lie beyond the last pixel.
    const bool usable = before.grey[index].contains(centre);
    if (usable) linearise(before.grey[index], centre, patch);
    if (!usable || patch.smaller_eigenvalue < kMinimumTexture) {
      if (finest) return std::nullopt;
      continue;
    }
    Eigen::Vector2d position = centre + shift * scale;
    for (int iteration = 0; iteration < kShiftIterations; ++iteration) {
      if (!target.contains(position)) break;
      samplePatch(target, position, moved);
      const Eigen::Vector2d step = patch.inverse_structure * mismatch(patch, moved);
      position -= step;
      if (step.squaredNorm() < kCoarse * kCoarse) break;
    }
    if (target.contains(position))
      shift = (position - centre) / scale;
    else if (finest)
      return std::nullopt;
    if (!finest) continue;
    samplePatch(target, position, moved);
    if (correlationOf(patch.grey, moved) < minimum_correlation) return std::nullopt;
  }
  const Eigen::Vector2d position = from + shift;
  if (!after.grey.front().contains(position)) return std::nullopt;
  return position;
}

KltResult trackPatch(const ImagePyramid& before, const ImagePyramid& after, const Eigen::Vector2d& from,
                     const Eigen::Vector2d& guess, int levels, const TrackingSettings& settings) {
  KltResult result;
  const auto shifted = trackShift(before, after, from, guess, {0, levels - 1},
                                  std::min(kWorthAligning, settings.minimum_correlation));
  if (!shifted) return result;
  AffineAlignment start;
  start.position = *shifted;
  const auto aligned = alignAffine(before.grey.front(), after.grey.front(), from, start, WarpModel::affine,
                                   settings.iterations, settings.convergence);
  if (!aligned) return result;
  result.position = aligned->position;
  result.correlation = aligned->correlation;
  result.found = result.correlation >= settings.minimum_correlation;
  return result;
}

}  // namespace cartvo
