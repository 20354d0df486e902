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
constexpr int kShiftIterations = 8;      // a shift that takes longer is lost
constexpr double kWorthAligning = 0.5;   // correlation after the shift, of which a warp may make a match
constexpr double kCoarse = 0.1;          // px: precise enough for a shift that will be refined
using Template = Patch<kSide, kSide>;

/// The patch before, its gradients (mean removed, which makes the shift blind to a change of brightness) and
/// the inverse of its structure matrix G (thesis 4.12).
struct Linearisation {
  Template grey;
  Template gradient_x;
  Template gradient_y;
  Eigen::Matrix2d inverse_structure;
  double smaller_eigenvalue = 0.0;  ///< of G, per pixel
};

void removeMean(Template& patch) {
  double sum = 0.0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      sum += patch.row(y)[x];
  const float mean = static_cast<float>(sum / (kSide * kSide));
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x)
      patch.row(y)[x] -= mean;
    for (int x = kSide; x < Template::kStride; ++x)
      patch.row(y)[x] = 0.0F;  // the padding takes no part in any sum
  }
}

void linearise(const PyramidLevel& level, const Eigen::Vector2d& centre, Linearisation& out) {
  Patch<kSide + 2, kSide + 2> wide;
  samplePatch(level, centre, wide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      out.grey.row(y)[x] = wide.row(y + 1)[x + 1];
      out.gradient_x.row(y)[x] = 0.5F * (wide.row(y + 1)[x + 2] - wide.row(y + 1)[x]);
      out.gradient_y.row(y)[x] = 0.5F * (wide.row(y + 2)[x + 1] - wide.row(y)[x + 1]);
    }
  }
  removeMean(out.grey);
  removeMean(out.gradient_x);
  removeMean(out.gradient_y);

  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (int i = 0; i < kSide * Template::kStride; ++i) {
    const double gx = out.gradient_x.value[i];
    const double gy = out.gradient_y.value[i];
    xx += gx * gx;
    xy += gx * gy;
    yy += gy * gy;
  }
  out.smaller_eigenvalue =
      (0.5 * (xx + yy) - std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy)) / (kSide * kSide);
  const double determinant = xx * yy - xy * xy;
  if (determinant > 0.0)
    out.inverse_structure << yy / determinant, -xy / determinant, -xy / determinant, xx / determinant;
}

/// The mismatch vector b (thesis 4.13).
Eigen::Vector2d mismatch(const Linearisation& before, const Template& after) {
  // A sum per column, added up at the end: the compiler may not reorder float sums by itself.
  float column_x[Template::kStride] = {};
  float column_y[Template::kStride] = {};
  for (int y = 0; y < kSide; ++y) {
    const float* now = after.row(y);
    const float* then = before.grey.row(y);
    const float* gx = before.gradient_x.row(y);
    const float* gy = before.gradient_y.row(y);
    for (int x = 0; x < Template::kStride; ++x) {
      const float difference = now[x] - then[x];
      column_x[x] += gx[x] * difference;
      column_y[x] += gy[x] * difference;
    }
  }
  Eigen::Vector2d sum(0.0, 0.0);
  for (int x = 0; x < Template::kStride; ++x)
    sum += Eigen::Vector2d(column_x[x], column_y[x]);
  return sum;
}

double correlationOf(const Template& centred_before, Template& after) {
  removeMean(after);
  double product = 0.0;
  double before_square = 0.0;
  double after_square = 0.0;
  for (int i = 0; i < kSide * Template::kStride; ++i) {
    const double then = centred_before.value[i];
    const double now = after.value[i];
    product += then * now;
    before_square += then * then;
    after_square += now * now;
  }
  return product / std::sqrt(std::max(before_square * after_square, 1e-12));
}

}  // namespace

KltResult trackPatch(const ImagePyramid& before, const ImagePyramid& after, const Eigen::Vector2d& from,
                     const Eigen::Vector2d& guess, const TrackingSettings& settings) {
  KltResult result;
  if (!before.grey.front().contains(from)) return result;
  Linearisation patch;
  Template moved;
  const int levels = static_cast<int>(std::min(before.grey.size(), after.grey.size()));
  Eigen::Vector2d shift = guess - from;  // px of the full image
  for (int index = levels - 1; index >= 0; --index) {
    const double scale = 1.0 / (1 << index);
    const PyramidLevel& target = after.grey[index];
    const Eigen::Vector2d centre = from * scale;
    // In a small level the centre of a pixel near the right or lower edge may lie beyond the last pixel.
    if (!before.grey[index].contains(centre)) continue;
    linearise(before.grey[index], centre, patch);
    if (patch.smaller_eigenvalue < kMinimumTexture) {
      if (index == 0) return result;
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
    else if (index == 0)
      return result;
  }
  result.position = from + shift;
  if (!after.grey.front().contains(result.position)) return result;
  samplePatch(after.grey.front(), result.position, moved);
  if (correlationOf(patch.grey, moved) < std::min(kWorthAligning, settings.minimum_correlation))
    return result;
  const auto aligned = alignAffine(before.grey.front(), after.grey.front(), from, result.position,
                                   settings.iterations, settings.convergence);
  if (!aligned) return result;
  result.position = aligned->position;
  result.correlation = aligned->correlation;
  result.found = result.correlation >= settings.minimum_correlation;
  return result;
}

}  // namespace cartvo
