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
/// Of the patch each other row is compared, which halves the work: neighbouring rows tell much the same.
constexpr int kRowStep = 2;
constexpr int kRows = (kSide + kRowStep - 1) / kRowStep;
constexpr int kParameters = 6;
constexpr int kStereoParameters = 4;  // the first four of the six
constexpr double kMinimumGain = 0.05;
constexpr double kMaximumStretch = 0.6;  // of any element of the warp against the identity
constexpr double kMaximumMove = 3.0;     // px from the start
constexpr int kPatience = 2;             // iterations after which a patch that is still hopeless is given up
constexpr double kHopeless = 0.5;        // correlation
constexpr double kMinimumPivot = 1e-4;   // relative, of the normal matrix
using Values = Patch<kSide, kRows>;
constexpr int kBlocks = Values::kBlocks;

/// The warp's parameters: shift x, y, then the warp's elements xx, xy, yx, yy, scaled by the patch's half
/// side so that all six are pixels.
using Parameters = Eigen::Matrix<double, kParameters, 1>;
using ParameterMatrix = Eigen::Matrix<double, kParameters, kParameters>;

/// A pixel's offset from the centre, scaled.
constexpr float scaledOffset(int pixel) {
  return static_cast<float>((pixel - kHalf) / (0.5 * kSide));
}
/// The same of a row that is compared.
constexpr float scaledRowOffset(int row) {
  return scaledOffset(kRowStep * row);
}
struct Ramp {
  Patch<kSide, 1> offset{};
  constexpr Ramp() {
    for (int x = 0; x < kSide; ++x)
      offset.value[x] = scaledOffset(x);
  }
};
constexpr Ramp kRamp;
constexpr Patch<kSide, 1> kMask = Values::mask();
struct Inner {
  Patch<kSide, 1> one{};
  constexpr Inner() {
    for (int x = 1; x < kSide - 1; ++x)
      one.value[x] = 1.0F;
  }
};
constexpr Inner kInner;

/// The patch before, its gradients, and what the normal equations need of them. A derivative by a parameter
/// is a gradient times 1 or the pixel's offset; from all, the mean is removed: brightness does not matter.
struct Template {
  Values grey;  // without its mean, zero in the padding
  Values gradient_x, gradient_y;
  float mean = 0.0F;
  double norm = 0.0;       // of grey
  Parameters slope_sums;   // of the derivatives
  Parameters slope_greys;  // of the derivatives times grey
  ParameterMatrix inverse;
};

/// The patch after under a warp, and how it compares with the template.
struct Comparison {
  Values now;  // less the template's mean, zero in the padding
  double mean = 0.0;
  double gain = 1.0;
  double correlation = 0.0;
  Parameters right_side;  // of the normal equations
};

/// Sums over the patch of a b (1, x, y, x^2, x y, y^2), x and y being the scaled offsets.
struct Moments {
  double one, x, y, xx, xy, yy;
};
void momentsOf(const Values& a, const Values& b, Moments& moments) {
  Lanes one{}, x{}, y{}, xx{}, xy{}, yy{};
  for (int row = 0; row < kRows; ++row) {
    const float offset_y = scaledRowOffset(row);
    for (int block = 0; block < kBlocks; ++block) {
      const Lanes& offset_x = kRamp.offset.lanes(0, block);
      const Lanes product = a.lanes(row, block) * b.lanes(row, block);
      const Lanes by_x = product * offset_x;
      one += product;
      x += by_x;
      y += product * offset_y;
      xx += by_x * offset_x;
      xy += by_x * offset_y;
      yy += product * (offset_y * offset_y);
    }
  }
  moments = {sumOf(one), sumOf(x), sumOf(y), sumOf(xx), sumOf(xy), sumOf(yy)};
}

/// Sums of the six derivatives times some values.
void slopeSums(const Template& patch, const Values& values, Parameters& sums) {
  Lanes x{}, x_by_x{}, x_by_y{}, y{}, y_by_x{}, y_by_y{};
  for (int row = 0; row < kRows; ++row) {
    const float offset_y = scaledRowOffset(row);
    for (int block = 0; block < kBlocks; ++block) {
      const Lanes& offset_x = kRamp.offset.lanes(0, block);
      const Lanes along_x = patch.gradient_x.lanes(row, block) * values.lanes(row, block);
      const Lanes along_y = patch.gradient_y.lanes(row, block) * values.lanes(row, block);
      x += along_x;
      x_by_x += along_x * offset_x;
      x_by_y += along_x * offset_y;
      y += along_y;
      y_by_x += along_y * offset_x;
      y_by_y += along_y * offset_y;
    }
  }
  sums << sumOf(x), sumOf(y), sumOf(x_by_x), sumOf(x_by_y), sumOf(y_by_x), sumOf(y_by_y);
}

/// Grey values and gradients, zero in the padding.
void sampleTemplate(const PyramidLevel& level, const Eigen::Vector2d& centre, Template& out) {
  sampleGradients<kRowStep>(level, centre, out.grey, out.gradient_x, out.gradient_y);
  out.mean = removeMean(out.grey);
  out.norm = std::sqrt(sumOfProducts(out.grey, out.grey));
}

/// Inverts the upper left corner, column by column: Eigen solves for a whole matrix by a routine for large
/// ones. False if it is nearly singular.
template <int Size>
bool invert(const ParameterMatrix& matrix, ParameterMatrix& inverse) {
  using Corner = Eigen::Matrix<double, Size, Size>;
  const Eigen::LLT<Corner> factor(matrix.topLeftCorner<Size, Size>());
  if (factor.info() != Eigen::Success) return false;
  const auto pivots = factor.matrixLLT().diagonal().array().square();
  if (!(pivots.minCoeff() > kMinimumPivot * pivots.maxCoeff())) return false;
  for (int column = 0; column < Size; ++column) {
    const Eigen::Matrix<double, Size, 1> unit = Eigen::Matrix<double, Size, 1>::Unit(column);
    inverse.col(column).head<Size>() = factor.solve(unit);
  }
  return true;
}

/// The Gauss-Newton matrix, of gradients' moments, and its inverse; false if the texture does not hold the
/// warp.
bool invertHessian(WarpModel model, Template& out) {
  Moments p, q, r;
  momentsOf(out.gradient_x, out.gradient_x, p);
  momentsOf(out.gradient_x, out.gradient_y, q);
  momentsOf(out.gradient_y, out.gradient_y, r);
  ParameterMatrix hessian;
  hessian << p.one, q.one, p.x, p.y, q.x, q.y,  //
      q.one, r.one, q.x, q.y, r.x, r.y,         //
      p.x, q.x, p.xx, p.xy, q.xx, q.xy,         //
      p.y, q.y, p.xy, p.yy, q.xy, q.yy,         //
      q.x, r.x, q.xx, q.xy, r.xx, r.xy,         //
      q.y, r.y, q.xy, q.yy, r.xy, r.yy;
  hessian -= out.slope_sums * out.slope_sums.transpose() / Values::kSize;
  if (model == WarpModel::stereo) {
    out.inverse.setZero();
    return invert<kStereoParameters>(hessian, out.inverse);
  }
  return invert<kParameters>(hessian, out.inverse);
}

bool makeTemplate(const PyramidLevel& level, const Eigen::Vector2d& centre, WarpModel model, Template& out) {
  sampleTemplate(level, centre, out);
  Values ones;
  for (int y = 0; y < kRows; ++y)
    for (int block = 0; block < kBlocks; ++block)
      ones.lanes(y, block) = kMask.lanes(0, block);
  slopeSums(out, ones, out.slope_sums);
  slopeSums(out, out.grey, out.slope_greys);
  return invertHessian(model, out);
}

/// Samples the level under the warp, by bilinear interpolation, in three passes: where, which pixels, what.
/// In between the numbers lie in memory, so that all but the gathering is done in lanes.
void sampleWarped(const PyramidLevel& level, const AffineAlignment& alignment, Values& out) {
  // Counted from a pixel left of and above all that is read: positive numbers are rounded down when
  // converted.
  constexpr int kBias = PyramidLevel::kBorder;
  const int centre_x = static_cast<int>(std::floor(alignment.position.x()));
  const int centre_y = static_cast<int>(std::floor(alignment.position.y()));
  const Eigen::Vector2f fraction =
      (alignment.position - Eigen::Vector2d(centre_x, centre_y)).cast<float>().array() + kBias;
  const Eigen::Matrix2f warp = alignment.warp.cast<float>();
  const std::ptrdiff_t stride = level.stride();
  const std::uint8_t* const corner = level.at(centre_x, centre_y) - kBias * stride - kBias;
  const float row_step = static_cast<float>(stride);

  constexpr int kPadded = kRows * Values::kStride;
  alignas(64) std::int32_t offset[kPadded];
  alignas(64) float fraction_x[kPadded], fraction_y[kPadded];
  for (int y = 0; y < kRows; ++y) {
    const Eigen::Vector2f start =
        fraction + warp * Eigen::Vector2f(-kHalf, static_cast<float>(kRowStep * y - kHalf));
    for (int block = 0; block < kBlocks; ++block) {
      const Lanes x = Lanes{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<float>(kLanes * block);
      const Lanes at_x = start.x() + warp(0, 0) * x;
      const Lanes at_y = start.y() + warp(1, 0) * x;
      const Lanes column = __builtin_convertvector(__builtin_convertvector(at_x, IntLanes), Lanes);
      const Lanes row = __builtin_convertvector(__builtin_convertvector(at_y, IntLanes), Lanes);
      const int at = y * Values::kStride + kLanes * block;
      *reinterpret_cast<Lanes*>(fraction_x + at) = at_x - column;
      *reinterpret_cast<Lanes*>(fraction_y + at) = at_y - row;
      // Below 2^24, so that the product is exact.
      *reinterpret_cast<IntLanes*>(offset + at) = __builtin_convertvector(row * row_step + column, IntLanes);
    }
  }

  // Two neighbours each. What is read for the padding would lie beyond the border.
  alignas(64) std::uint16_t upper[kPadded], lower[kPadded];
  for (int y = 0; y < kRows; ++y) {
    std::uint16_t* const above = upper + y * Values::kStride;
    std::uint16_t* const below = lower + y * Values::kStride;
    for (int x = 0; x < kSide; ++x) {
      const std::uint8_t* const pixel = corner + offset[y * Values::kStride + x];
      std::memcpy(above + x, pixel, 2);
      std::memcpy(below + x, pixel + stride, 2);
      asm volatile("");  // Else the compiler gathers into registers first, which takes four times as long.
    }
    above[kSide] = below[kSide] = 0;
  }

  for (int i = 0; i < kPadded; i += kLanes) {
    const IntLanes above = __builtin_convertvector(*reinterpret_cast<ShortLanes*>(upper + i), IntLanes);
    const IntLanes below = __builtin_convertvector(*reinterpret_cast<ShortLanes*>(lower + i), IntLanes);
    const Lanes above_left = __builtin_convertvector(above & 0xff, Lanes);
    const Lanes above_right = __builtin_convertvector(above >> 8, Lanes);
    const Lanes below_left = __builtin_convertvector(below & 0xff, Lanes);
    const Lanes below_right = __builtin_convertvector(below >> 8, Lanes);
    const Lanes& fx = *reinterpret_cast<Lanes*>(fraction_x + i);
    const Lanes top = above_left + fx * (above_right - above_left);
    const Lanes bottom = below_left + fx * (below_right - below_left);
    *reinterpret_cast<Lanes*>(out.value + i) =
        top + *reinterpret_cast<Lanes*>(fraction_y + i) * (bottom - top);
  }
}

/// The patch's gain is taken out, else a darker image would shorten each step.
void compare(const Template& before, const PyramidLevel& after, const AffineAlignment& alignment,
             Comparison& out) {
  sampleWarped(after, alignment, out.now);
  Lanes sums{}, squares{}, products{};
  for (int y = 0; y < kRows; ++y) {
    for (int block = 0; block < kBlocks; ++block) {
      Lanes& value = out.now.lanes(y, block);
      value = (value - before.mean) * kMask.lanes(0, block);  // small numbers, so that little is rounded
      sums += value;
      squares += value * value;
      products += value * before.grey.lanes(y, block);
    }
  }
  out.mean = sumOf(sums) / Values::kSize;
  const double variance = sumOf(squares) - Values::kSize * out.mean * out.mean;
  const double product = sumOf(products);
  out.correlation = product / (before.norm * std::sqrt(std::max(variance, 1e-6)) + 1e-12);
  out.gain = std::max(product / (before.norm * before.norm + 1e-12), kMinimumGain);
  Parameters slopes;
  slopeSums(before, out.now, slopes);
  out.right_side = (slopes - out.mean * before.slope_sums) / out.gain - before.slope_greys;
}

/// px between the shift that the template's gradients ask for and that by the gradients of the patch after:
/// backwards, from the patch after to the template, one would miss the start by so much.
double returnMissOf(const Template& before, const Comparison& at) {
  Lanes xx{}, xy{}, yy{}, x{}, y{}, forward_xx{}, forward_xy{}, forward_yy{}, forward_x{}, forward_y{};
  const float gain = static_cast<float>(at.gain), mean = static_cast<float>(at.mean);
  for (int row = 1; row < kRows - 1; ++row) {
    for (int block = 0; block < kBlocks; ++block) {
      const float* const here = at.now.row(row) + kLanes * block;
      Lanes left, right;
      std::memcpy(&left, here - 1, sizeof left);
      std::memcpy(&right, here + 1, sizeof right);
      const Lanes& mask = kInner.one.lanes(0, block);
      const Lanes slope_x = mask * (right - left);
      const Lanes slope_y =
          mask / (1.0F * kRowStep) * (at.now.lanes(row + 1, block) - at.now.lanes(row - 1, block));
      const Lanes error = at.now.lanes(row, block) - mean - gain * before.grey.lanes(row, block);
      xx += slope_x * slope_x;
      xy += slope_x * slope_y;
      yy += slope_y * slope_y;
      x += slope_x * error;
      y += slope_y * error;
      const Lanes before_x = mask * before.gradient_x.lanes(row, block);
      const Lanes before_y =
          mask * (0.5F / kRowStep) * (before.grey.lanes(row + 1, block) - before.grey.lanes(row - 1, block));
      forward_xx += before_x * before_x;
      forward_xy += before_x * before_y;
      forward_yy += before_y * before_y;
      forward_x += before_x * error;
      forward_y += before_y * error;
    }
  }
  Eigen::Matrix2d backward_structure, forward_structure;
  backward_structure << sumOf(xx), sumOf(xy), sumOf(xy), sumOf(yy);
  forward_structure << sumOf(forward_xx), sumOf(forward_xy), sumOf(forward_xy), sumOf(forward_yy);
  const Eigen::Vector2d backward = 2.0 * backward_structure.inverse() * Eigen::Vector2d(sumOf(x), sumOf(y));
  const Eigen::Vector2d forward =
      forward_structure.inverse() * Eigen::Vector2d(sumOf(forward_x), sumOf(forward_y)) / at.gain;
  const double miss = (backward - forward).norm();
  return miss < kMaximumMove ? miss : kMaximumMove;
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
  if (!makeTemplate(before, from, model, patch)) return std::nullopt;

  Comparison at;
  AffineAlignment alignment = start;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    compare(patch, after, alignment, at);
    if (iteration >= kPatience && at.correlation < kHopeless) return std::nullopt;
    const Parameters step = patch.inverse * at.right_side;
    Eigen::Matrix2d stretch;
    stretch << step[2], step[3], step[4], step[5];
    const Eigen::Matrix2d change = (Eigen::Matrix2d::Identity() + stretch / (0.5 * kSide)).inverse();
    alignment.warp = alignment.warp * change;
    alignment.position -= alignment.warp * step.head<2>();
    if (!plausible(alignment, start.position, after)) return std::nullopt;
    // A step so short hardly changes the correlation that was found before it.
    if (step.squaredNorm() < convergence * convergence) break;
  }
  alignment.correlation = at.correlation;
  alignment.return_miss = returnMissOf(patch, at);
  return alignment;
}

}  // namespace cartvo
