// The last step of tracking: the patch may stretch and shear.
#include "vo_core/affine_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "vo_core/patch.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo {
namespace {

constexpr int kSide = 15;  // px
constexpr int kHalf = kSide / 2;
constexpr int kCount = kSide * kSide;
constexpr double kMaximumStretch = 0.6;  // of any element of the warp against the identity
constexpr double kMaximumMove = 3.0;     // px from the start
constexpr double kMinimumPivot = 1e-4;   // relative, of the normal matrix

/// The patch before and the derivatives of its values by the warp's parameters: shift x, y, then the warp's
/// elements xx, xy, yx, yy, scaled by the patch's half side so that all six are pixels.
struct Template {
  double grey[kCount];
  Vector6d slope[kCount];
  Vector6d mean_slope = Vector6d::Zero();
  double mean_grey = 0.0;
  double norm = 0.0;                    // of the values with their mean removed
  Matrix6d hessian = Matrix6d::Zero();  // of slopes with their mean removed: brightness does not matter
};

void makeTemplate(const PyramidLevel& level, const Eigen::Vector2d& centre, Template& out) {
  Patch<kSide + 2, kSide + 2> wide;
  samplePatch(level, centre, wide);
  double square = 0.0;
  for (int y = 0, i = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x, ++i) {
      const double gx = 0.5 * (wide.row(y + 1)[x + 2] - wide.row(y + 1)[x]);
      const double gy = 0.5 * (wide.row(y + 2)[x + 1] - wide.row(y)[x + 1]);
      const double dx = (x - kHalf) / (0.5 * kSide);
      const double dy = (y - kHalf) / (0.5 * kSide);
      out.slope[i] << gx, gy, gx * dx, gx * dy, gy * dx, gy * dy;
      out.grey[i] = wide.row(y + 1)[x + 1];
      out.hessian += out.slope[i] * out.slope[i].transpose();
      out.mean_slope += out.slope[i];
      out.mean_grey += out.grey[i];
      square += out.grey[i] * out.grey[i];
    }
  }
  out.mean_slope /= kCount;
  out.mean_grey /= kCount;
  out.hessian -= kCount * out.mean_slope * out.mean_slope.transpose();
  out.norm = std::sqrt(std::max(square - kCount * out.mean_grey * out.mean_grey, 0.0));
}

/// Bilinear; at most kBorder - 2 outside the level.
double sample(const PyramidLevel& level, double x, double y) {
  const double floor_x = std::floor(x);
  const double floor_y = std::floor(y);
  const double fx = x - floor_x;
  const double fy = y - floor_y;
  const float* upper = level.at<float>(static_cast<int>(floor_x), static_cast<int>(floor_y));
  const float* lower = level.at<float>(static_cast<int>(floor_x), static_cast<int>(floor_y) + 1);
  return (1.0 - fy) * (upper[0] + fx * (upper[1] - upper[0])) + fy * (lower[0] + fx * (lower[1] - lower[0]));
}

/// Samples the warped patch, gives the right side of the normal equations and the correlation.
Vector6d compare(const Template& before, const PyramidLevel& after, AffineAlignment& alignment) {
  Vector6d sum = Vector6d::Zero();
  double grey_sum = 0.0;
  double square = 0.0;
  double product = 0.0;
  for (int y = 0, i = 0; y < kSide; ++y) {
    const Eigen::Vector2d row = alignment.position + alignment.warp.col(1) * (y - kHalf);
    for (int x = 0; x < kSide; ++x, ++i) {
      const Eigen::Vector2d at = row + alignment.warp.col(0) * (x - kHalf);
      const double grey = sample(after, at.x(), at.y());
      sum += before.slope[i] * (grey - before.grey[i]);
      grey_sum += grey;
      square += grey * grey;
      product += grey * (before.grey[i] - before.mean_grey);
    }
  }
  const double variance = square - grey_sum * grey_sum / kCount;
  alignment.correlation = product / (before.norm * std::sqrt(std::max(variance, 1e-6)) + 1e-12);
  return sum - before.mean_slope * (grey_sum - kCount * before.mean_grey);
}

bool plausible(const AffineAlignment& alignment, const Eigen::Vector2d& start, const PyramidLevel& after) {
  return (alignment.warp - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff() <= kMaximumStretch &&
         (alignment.position - start).norm() <= kMaximumMove && after.contains(alignment.position);
}

}  // namespace

std::optional<AffineAlignment> alignAffine(const PyramidLevel& before, const PyramidLevel& after,
                                           const Eigen::Vector2d& from, const Eigen::Vector2d& start,
                                           int iterations, double convergence) {
  // Warped by at most 1.6 in each of two directions, the patch reaches 22.4 px: the border holds it.
  static_assert(kHalf * 2 * (1.0 + kMaximumStretch) < PyramidLevel::kBorder - 1);
  Template patch;
  makeTemplate(before, from, patch);
  const Eigen::LDLT<Matrix6d> factor(patch.hessian);
  const auto pivots = factor.vectorD();
  if (!(pivots.minCoeff() > kMinimumPivot * pivots.maxCoeff())) return std::nullopt;

  AffineAlignment alignment;
  alignment.position = start;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const Vector6d step = factor.solve(compare(patch, after, alignment));
    Eigen::Matrix2d stretch;
    stretch << step[2], step[3], step[4], step[5];
    const Eigen::Matrix2d change = (Eigen::Matrix2d::Identity() + stretch / (0.5 * kSide)).inverse();
    alignment.warp = alignment.warp * change;
    alignment.position -= alignment.warp * step.head<2>();
    if (!plausible(alignment, start, after)) return std::nullopt;
    if (step.squaredNorm() < convergence * convergence) break;
  }
  compare(patch, after, alignment);
  return alignment;
}

}  // namespace cartvo
