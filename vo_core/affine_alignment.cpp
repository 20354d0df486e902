// The last step of tracking: the patch may stretch and shear.
#include "vo_core/affine_alignment.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "vo_core/patch.hpp"
#include "vo_core/small_inverse.hpp"
#include "vo_core/warped_patch.hpp"

namespace cartvo {
namespace {

constexpr int kSide = kPatchSide;
constexpr int kHalf = kSide / 2;
/// Of the patch each other row is compared, which halves the work: neighbouring rows tell much the same.
constexpr int kRowStep = 2;
constexpr int kRows = (kSide + kRowStep - 1) / kRowStep;
constexpr int kParameters = 6;
constexpr int kStereoParameters = 4;  // the first four of the six
constexpr double kMinimumGain = 0.05;
constexpr double kMaximumStretch = 0.6;                   // of any element of the warp against the identity
constexpr double kMaximumMove = 3.0;                      // px from the start
constexpr double kShiftShare = 0.5, kStretchShare = 3.0;  // of the step that ends the iterations
constexpr int kPatience = 1;            // iterations after which a patch that is still hopeless is given up
constexpr double kHopeless = 0.6;       // correlation
constexpr double kMinimumPivot = 1e-4;  // relative, of the normal matrix
using Values = Patch<kSide, kRows>;
constexpr double kPerPixel = 1.0 / Values::kSize;  // dividing takes long, and much waits for it
constexpr double kPerHalfSide = 2.0 / kSide;
static_assert(Values::kBlocks == 1, "a row is one vector of lanes");

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

/// Sums over the patch of something times 1 or the scaled row offset, column by column.
struct ColumnSums {
  Lanes one{}, y{};

  void add(const Lanes& lanes, float offset_y) {
    one += lanes;
    y += lanes * offset_y;
  }
};

/// Sums of the six derivatives, in the order of the parameters, from those of the gradients.
void slopeSums(const ColumnSums& along_x, const ColumnSums& along_y, Parameters& sums) {
  const Lanes& ramp = kRamp.offset.lanes(0, 0);
  const Lanes x_by_x = along_x.one * ramp, y_by_x = along_y.one * ramp;
  std::array<double, 4> first, second;
  sumsOf(along_x.one, along_y.one, x_by_x, along_x.y, first.data());
  sumsOf(y_by_x, along_y.y, y_by_x, along_y.y, second.data());
  sums << first[0], first[1], first[2], first[3], second[0], second[1];
}

/// Sums of the six derivatives times some values.
void slopeProducts(const Template& patch, const Values& values, Parameters& sums) {
  ColumnSums along_x, along_y;
  for (int row = 0; row < kRows; ++row) {
    const float offset_y = scaledRowOffset(row);
    along_x.add(patch.gradient_x.lanes(row, 0) * values.lanes(row, 0), offset_y);
    along_y.add(patch.gradient_y.lanes(row, 0) * values.lanes(row, 0), offset_y);
  }
  slopeSums(along_x, along_y, sums);
}

/// Grey values and gradients, zero in the padding, and the sums of derivatives.
template <typename Processor>
void sampleTemplate(const PyramidLevel& level, const Eigen::Vector2d& centre, Template& out) {
  sampleGradients<Processor, kRowStep>(level, centre, out.grey, out.gradient_x, out.gradient_y);
  out.mean = removeMean(out.grey);
  out.norm = std::sqrt(sumOfProducts(out.grey, out.grey));
  ColumnSums along_x, along_y;
  for (int row = 0; row < kRows; ++row) {
    along_x.add(out.gradient_x.lanes(row, 0), scaledRowOffset(row));
    along_y.add(out.gradient_y.lanes(row, 0), scaledRowOffset(row));
  }
  slopeSums(along_x, along_y, out.slope_sums);
  slopeProducts(out, out.grey, out.slope_greys);
}

/// Sums over the patch of a b (1, x, y, x^2, x y, y^2), x and y being the scaled offsets.
struct Moments {
  double one, x, y, xx, xy, yy;
};
void momentsOf(const Values& a, const Values& b, Moments& moments) {
  Lanes one{}, y{}, yy{};
  for (int row = 0; row < kRows; ++row) {
    const float offset_y = scaledRowOffset(row);
    const Lanes product = a.lanes(row, 0) * b.lanes(row, 0);
    one += product;
    y += product * offset_y;
    yy += product * (offset_y * offset_y);
  }
  const Lanes& ramp = kRamp.offset.lanes(0, 0);
  const Lanes x = one * ramp, xx = x * ramp, xy = y * ramp;
  std::array<double, 4> first, second;
  sumsOf(one, x, y, xx, first.data());
  sumsOf(xy, yy, xy, yy, second.data());
  moments = {first[0], first[1], first[2], first[3], second[0], second[1]};
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
  hessian.noalias() -= out.slope_sums * (kPerPixel * out.slope_sums).transpose();
  if (model == WarpModel::stereo) {
    out.inverse.setZero();
    return invertCorner<kStereoParameters>(hessian, kMinimumPivot, out.inverse);
  }
  return invertCorner<kParameters>(hessian, kMinimumPivot, out.inverse);
}

/// The patch's gain is taken out, else a darker image would shorten each step.
template <typename Processor>
void compare(const Template& before, const PyramidLevel& after, const AffineAlignment& alignment,
             Comparison& out) {
  using Rows = WarpedRows<Processor, kSide, kRowStep>;
  Rows rows(after, alignment.position, alignment.warp);
  Lanes sum{}, squares{}, products{};
  ColumnSums along_x, along_y;
  for (int y = 0; y < kRows; ++y) {
    Lanes sampled;
    rows.sample(sampled);
    // Small numbers, so that little is rounded.
    const Lanes value = (sampled * Rows::kUnit - before.mean) * kMask.lanes(0, 0);
    out.now.lanes(y, 0) = value;
    sum += value;
    squares += value * value;
    products += value * before.grey.lanes(y, 0);
    along_x.add(before.gradient_x.lanes(y, 0) * value, scaledRowOffset(y));
    along_y.add(before.gradient_y.lanes(y, 0) * value, scaledRowOffset(y));
  }
  std::array<double, 4> sums;
  sumsOf(sum, squares, products, products, sums.data());
  const double product = sums[2];
  out.mean = sums[0] * kPerPixel;
  const double variance = sums[1] - Values::kSize * out.mean * out.mean;
  out.correlation = product / (before.norm * std::sqrt(std::max(variance, 1e-6)) + 1e-12);
  out.gain = std::max(product / (before.norm * before.norm + 1e-12), kMinimumGain);
  Parameters slopes;
  slopeSums(along_x, along_y, slopes);
  out.right_side = (slopes - out.mean * before.slope_sums) * (1.0 / out.gain) - before.slope_greys;
}

/// Sums of products of a patch's slopes with each other and with an error.
struct ShiftEquations {
  Lanes xx{}, xy{}, yy{}, x{}, y{};

  void add(const Lanes& slope_x, const Lanes& slope_y, const Lanes& error) {
    xx += slope_x * slope_x;
    xy += slope_x * slope_y;
    yy += slope_y * slope_y;
    x += slope_x * error;
    y += slope_y * error;
  }
  Eigen::Vector2d solve() const {
    std::array<double, 4> sums;
    sumsOf(xx, xy, yy, x, sums.data());
    const double right_x = sums[3], right_y = sumOf(y);
    return Eigen::Vector2d(sums[2] * right_x - sums[1] * right_y, sums[0] * right_y - sums[1] * right_x) /
           (sums[0] * sums[2] - sums[1] * sums[1]);
  }
};

/// px between the shift that the template's gradients ask for and that by the gradients of the patch after:
/// backwards, from the patch after to the template, one would miss the start by so much.
double returnMissOf(const Template& before, const Comparison& at) {
  ShiftEquations backward, forward;
  const float gain = static_cast<float>(at.gain), mean = static_cast<float>(at.mean);
  const Lanes& mask = kInner.one.lanes(0, 0);
  for (int row = 1; row < kRows - 1; ++row) {
    const float* const here = at.now.row(row);
    Lanes left, right;
    std::memcpy(&left, here - 1, sizeof left);
    std::memcpy(&right, here + 1, sizeof right);
    const Lanes error = at.now.lanes(row, 0) - mean - gain * before.grey.lanes(row, 0);
    backward.add(mask * (right - left),
                 mask / (1.0F * kRowStep) * (at.now.lanes(row + 1, 0) - at.now.lanes(row - 1, 0)), error);
    forward.add(mask * before.gradient_x.lanes(row, 0),
                mask * (0.5F / kRowStep) * (before.grey.lanes(row + 1, 0) - before.grey.lanes(row - 1, 0)),
                error);
  }
  const double miss = (2.0 * backward.solve() - forward.solve() / at.gain).norm();
  return miss < kMaximumMove ? miss : kMaximumMove;
}

bool plausible(const AffineAlignment& alignment, const Eigen::Vector2d& start, const PyramidLevel& after) {
  return (alignment.warp - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff() <= kMaximumStretch &&
         (alignment.position - start).squaredNorm() <= kMaximumMove * kMaximumMove &&
         after.contains(alignment.position);
}

/// Whether a step is too short for another to be worth it. What stretches the patch moves its edge and not
/// its centre, so that less is asked of it.
bool settled(const Parameters& step, double convergence) {
  const double shift = kShiftShare * convergence, stretch = kStretchShare * convergence;
  return step.head<2>().squaredNorm() < shift * shift && step.tail<4>().squaredNorm() < stretch * stretch;
}

/// What alignAffine is asked.
struct Question {
  const PyramidLevel& before;
  const PyramidLevel& after;
  const Eigen::Vector2d& from;
  const AffineAlignment& start;
  WarpModel model;
  int iterations;
  double convergence;
};

template <typename Processor>
std::optional<AffineAlignment> answer(const Question& asked) {
  // Warped by at most 1.6 in each of two directions, the patch reaches 22.4 px: the border holds it.
  static_assert(kHalf * 2 * (1.0 + kMaximumStretch) < PyramidLevel::kBorder - 1);
  const AffineAlignment& start = asked.start;
  if (!plausible(start, start.position, asked.after)) return std::nullopt;
  Template patch;
  sampleTemplate<Processor>(asked.before, asked.from, patch);
  if (!invertHessian(asked.model, patch)) return std::nullopt;

  Comparison at;
  AffineAlignment alignment = start;
  for (int iteration = 0; iteration < asked.iterations; ++iteration) {
    compare<Processor>(patch, asked.after, alignment, at);
    if (iteration >= kPatience && at.correlation < kHopeless) return std::nullopt;
    const Parameters step = patch.inverse * at.right_side;
    Eigen::Matrix2d stretch;
    stretch << step[2], step[3], step[4], step[5];
    const Eigen::Matrix2d change = (Eigen::Matrix2d::Identity() + kPerHalfSide * stretch).inverse();
    alignment.warp = alignment.warp * change;
    alignment.position -= alignment.warp * step.head<2>();
    if (!plausible(alignment, start.position, asked.after)) return std::nullopt;
    // A step so short hardly changes the correlation that was found before it.
    if (settled(step, asked.convergence)) break;
  }
  alignment.correlation = at.correlation;
  alignment.return_miss = returnMissOf(patch, at);
  return alignment;
}

CARTVO_VECTOR_CLONES
std::optional<AffineAlignment> answerAnywhere(const Question& asked) {
  return answer<AnyProcessor>(asked);
}

#ifdef CARTVO_BYTE_SHUFFLES
CARTVO_BYTE_SHUFFLES
std::optional<AffineAlignment> answerByShuffles(const Question& asked) {
  return answer<ByteShufflingProcessor>(asked);
}
#endif

}  // namespace

std::optional<AffineAlignment> alignAffine(const PyramidLevel& before, const PyramidLevel& after,
                                           const Eigen::Vector2d& from, const AffineAlignment& start,
                                           WarpModel model, int iterations, double convergence) {
  const Question asked{before, after, from, start, model, iterations, convergence};
#ifdef CARTVO_BYTE_SHUFFLES
  if (shufflesBytes()) return answerByShuffles(asked);
#endif
  return answerAnywhere(asked);
}

}  // namespace cartvo
