// The last step of tracking: the patch may stretch and shear.
#include "vo_core/affine_alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "vo_core/patch.hpp"

namespace cartvo {
namespace {

constexpr int kSide = 15;  // px
constexpr int kHalf = kSide / 2;
constexpr int kMaximumParameters = 6;
constexpr int kStereoParameters = 4;  // the first four of the six
constexpr double kMinimumGain = 0.05;
constexpr double kMaximumStretch = 0.6;  // of any element of the warp against the identity
constexpr double kMaximumMove = 3.0;     // px from the start
constexpr double kMinimumPivot = 1e-4;   // relative, of the normal matrix
using Values = Patch<kSide, kSide>;      // the padding is zero in all but the sampled one

using Parameters = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaximumParameters, 1>;
using ParameterMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaximumParameters, kMaximumParameters>;

/// The patch before and the derivatives of its values by the warp's parameters: shift x, y, then the warp's
/// elements xx, xy, yx, yy, scaled by the patch's half side so that all six are pixels. From all, the mean is
/// removed: brightness does not matter.
struct Template {
  Values grey;
  Values slope[kMaximumParameters];
  int parameters = kMaximumParameters;
  double norm = 0.0;  // of the values
  ParameterMatrix hessian;
};

Values makeRamp() {
  Values ramp{};
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      ramp.row(y)[x] = static_cast<float>((x - kHalf) / (0.5 * kSide));
  return ramp;
}

void makeTemplate(const PyramidLevel& level, const Eigen::Vector2d& centre, WarpModel model, Template& out) {
  out.parameters = model == WarpModel::stereo ? kStereoParameters : kMaximumParameters;
  static const Values kRamp = makeRamp();  // of a pixel's x offset, scaled
  Patch<kSide + 2, kSide + 2> wide;
  samplePatch(level, centre, wide);
  for (int y = 0; y < kSide; ++y) {
    const float dy = kRamp.row(0)[y];
    const float* dx = kRamp.row(y);
    const float* above = wide.row(y);
    const float* row = wide.row(y + 1);
    const float* below = wide.row(y + 2);
    for (int x = 0; x < Values::kStride; ++x) {
      const float gx = 0.5F * (row[x + 2] - row[x]);
      const float gy = 0.5F * (below[x + 1] - above[x + 1]);
      out.grey.row(y)[x] = row[x + 1];
      out.slope[0].row(y)[x] = gx;
      out.slope[1].row(y)[x] = gy;
      out.slope[2].row(y)[x] = gx * dx[x];
      out.slope[3].row(y)[x] = gx * dy;
      out.slope[4].row(y)[x] = gy * dx[x];
      out.slope[5].row(y)[x] = gy * dy;
    }
  }
  removeMean(out.grey);
  for (int i = 0; i < out.parameters; ++i)
    removeMean(out.slope[i]);
  out.hessian.resize(out.parameters, out.parameters);
  for (int i = 0; i < out.parameters; ++i)
    for (int j = 0; j <= i; ++j)
      out.hessian(i, j) = out.hessian(j, i) = sumOfProducts(out.slope[i], out.slope[j]);
  out.norm = std::sqrt(sumOfProducts(out.grey, out.grey));
}

/// Samples the level under the warp, by bilinear interpolation. Row by row in three steps, of which the
/// compiler makes vector instructions of all but the gathering.
void sampleWarped(const PyramidLevel& level, const AffineAlignment& alignment, Values& out) {
  // Counted from the pixel of the centre: a float is precise enough for so few pixels. What is converted to
  // int is positive, so that it is rounded down.
  constexpr int kBias = PyramidLevel::kBorder;
  const int centre_x = static_cast<int>(std::floor(alignment.position.x()));
  const int centre_y = static_cast<int>(std::floor(alignment.position.y()));
  const Eigen::Vector2f fraction =
      (alignment.position - Eigen::Vector2d(centre_x, centre_y)).cast<float>().array() + kBias;
  const Eigen::Matrix2f warp = alignment.warp.cast<float>();
  const float* const corner = level.at<float>(centre_x, centre_y);
  const std::ptrdiff_t stride = level.at<float>(0, 1) - level.at<float>(0, 0);

  for (int y = 0; y < kSide; ++y) {
    const Eigen::Vector2f start = fraction + warp * Eigen::Vector2f(-kHalf, static_cast<float>(y - kHalf));
    int column[Values::kStride];
    int row[Values::kStride];
    float fx[Values::kStride];
    float fy[Values::kStride];
    for (int x = 0; x < Values::kStride; ++x) {
      const float at_x = start.x() + warp(0, 0) * static_cast<float>(x);
      const float at_y = start.y() + warp(1, 0) * static_cast<float>(x);
      column[x] = static_cast<int>(at_x);
      row[x] = static_cast<int>(at_y);
      fx[x] = at_x - static_cast<float>(column[x]);
      fy[x] = at_y - static_cast<float>(row[x]);
    }
    float neighbour[4][Values::kStride];
    for (int x = 0; x < kSide; ++x) {
      const float* pixel = corner + (row[x] - kBias) * stride + (column[x] - kBias);
      neighbour[0][x] = pixel[0];
      neighbour[1][x] = pixel[1];
      neighbour[2][x] = pixel[stride];
      neighbour[3][x] = pixel[stride + 1];
    }
    for (float(&values)[Values::kStride] : neighbour)
      values[kSide] = 0.0F;
    for (int x = 0; x < Values::kStride; ++x) {
      const float upper = neighbour[0][x] + fx[x] * (neighbour[1][x] - neighbour[0][x]);
      const float lower = neighbour[2][x] + fx[x] * (neighbour[3][x] - neighbour[2][x]);
      out.row(y)[x] = upper + fy[x] * (lower - upper);
    }
  }
}

/// Samples the warped patch, gives the right side of the normal equations and the correlation. The patch's
/// gain is taken out, else a darker image would shorten each step.
Parameters compare(const Template& before, const PyramidLevel& after, AffineAlignment& alignment) {
  Values now;
  sampleWarped(after, alignment, now);
  removeMean(now);
  const double variance = sumOfProducts(now, now);
  const double product = sumOfProducts(now, before.grey);
  alignment.correlation = product / (before.norm * std::sqrt(std::max(variance, 1e-6)) + 1e-12);
  const double gain = std::max(product / (before.norm * before.norm + 1e-12), kMinimumGain);
  const float inverse_gain = static_cast<float>(1.0 / gain);
  for (int i = 0; i < kSide * Values::kStride; ++i)
    now.value[i] = inverse_gain * now.value[i] - before.grey.value[i];
  Parameters sum(before.parameters);
  for (int i = 0; i < before.parameters; ++i)
    sum[i] = sumOfProducts(before.slope[i], now);
  return sum;
}

bool plausible(const AffineAlignment& alignment, const Eigen::Vector2d& start, const PyramidLevel& after) {
  return (alignment.warp - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff() <= kMaximumStretch &&
         (alignment.position - start).norm() <= kMaximumMove && after.contains(alignment.position);
}

}  // namespace

CARTVO_VECTOR_CLONES
std::optional<AffineAlignment> alignAffine(const PyramidLevel& before, const PyramidLevel& after,
                                           const Eigen::Vector2d& from, const AffineAlignment& start,
                                           WarpModel model, int iterations, double convergence) {
  // Warped by at most 1.6 in each of two directions, the patch reaches 22.4 px: the border holds it.
  static_assert(kHalf * 2 * (1.0 + kMaximumStretch) < PyramidLevel::kBorder - 1);
  if (!plausible(start, start.position, after)) return std::nullopt;
  Template patch;
  makeTemplate(before, from, model, patch);
  const Eigen::LDLT<ParameterMatrix> factor(patch.hessian);
  const auto pivots = factor.vectorD();
  if (!(pivots.minCoeff() > kMinimumPivot * pivots.maxCoeff())) return std::nullopt;

  AffineAlignment alignment = start;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const Parameters step = factor.solve(compare(patch, after, alignment));
    Eigen::Matrix2d stretch = Eigen::Matrix2d::Zero();
    stretch.row(0) = step.segment<2>(2);
    if (model == WarpModel::affine) stretch.row(1) = step.segment<2>(4);
    const Eigen::Matrix2d change = (Eigen::Matrix2d::Identity() + stretch / (0.5 * kSide)).inverse();
    alignment.warp = alignment.warp * change;
    alignment.position -= alignment.warp * step.head<2>();
    if (!plausible(alignment, start.position, after)) return std::nullopt;
    // A step so short does not change the correlation that was found before it.
    if (step.squaredNorm() < convergence * convergence) return alignment;
  }
  compare(patch, after, alignment);
  return alignment;
}

}  // namespace cartvo
