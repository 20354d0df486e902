#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>

#include "vo_core/image/aligned_patch.hpp"
#include "vo_core/image/constant_fraction_sampler.hpp"
#include "vo_core/image/patch_lanes.hpp"
#include "vo_core/image/patch_sums.hpp"
#include "vo_core/simd/double_lanes.hpp"
#include "vo_core/stereo/subpixel_fit.hpp"

// Search for the peak of the normalised cross-correlation (NCC) with the right image. Internal to the stereo
// search.

namespace cartvo::vo {

constexpr int kNccColumns = 15, kNccRows = 9;    ///< px, size of the windows that are correlated
constexpr int kNccRadius = 2;                    ///< px to the left and right in which a peak may lie
constexpr int kNccSamples = 2 * kNccRadius + 3;  ///< one more on each side, for the sub-pixel fit

constexpr int kNccSize = kNccColumns * kNccRows;
static_assert(kNccSize * kMaximumValue * kMaximumValue / 4 < 2147483648.0,
              "sums of products fit into 32 bits");

/// Left patch in integers, in units of two AlignedPatch units.
struct NccTemplate {
  alignas(64) std::int16_t value[wholeFours(kNccRows) * kLanes];  ///< zero in the padding
  double mean = 0.0;
  double norm = 0.0;  ///< norm of the values less their mean

  const std::int16_t* row(int y) const { return value + y * kLanes; }
};

inline void makeTemplate(const PyramidLevel& level, const Eigen::Vector2d& pixel, NccTemplate& out) {
  ConstantFractionSampler rows(level, pixel, kNccColumns / 2, kNccRows / 2);
  IntLanes sum, other;
  for (int y = 0; y < kNccRows; y += 2) {
    rows.load(y);
    rows.template sample<0>(sum);
    rows.load(y + 1);
    rows.template sample<0>(other);
    PatchLanes::storeHalf(sum, other, out.value + y * kLanes);
  }
  std::fill(std::begin(out.value) + kNccRows * kLanes, std::end(out.value), 0);
  std::int32_t values = 0, squares = 0;
  for (const std::int16_t value : out.value) {
    values += value;
    squares += value * value;
  }
  out.mean = static_cast<double>(values) / kNccSize;
  out.norm = std::sqrt(squares - out.mean * values);
}

/// Three neighbouring correlations, the greatest in the middle.
struct NccPeak {
  int row = 0, middle_column = 0;  ///< px from the centre of the search
  double left = 0.0, middle = 0.0, right = 0.0;
  double height = 0.0;  ///< of the fitted peak; 0: there is none

  double column() const { return middle_column + sinusoidalOffset(left, middle, right); }
};

namespace ncc_detail {

/// Strip of pixels that the windows around a position cover: rows of 32, which is more than they need.
template <int Rows>
struct Strip {
  static constexpr int kRows = kNccRows + 2 * Rows, kColumns = kNccColumns + kNccSamples - 1;
  static constexpr int kStride = 2 * kLanes;
  alignas(64) std::int16_t value[kRows * kStride];

  std::int16_t* row(int y) { return value + y * kStride; }
  const std::int16_t* row(int y) const { return value + y * kStride; }
};

template <int Rows>
void sampleStrip(const PyramidLevel& level, const Eigen::Vector2d& centre, Strip<Rows>& strip) {
  ConstantFractionSampler rows(level, centre, Strip<Rows>::kColumns / 2, Strip<Rows>::kRows / 2);
  for (int y = 0; y < Strip<Rows>::kRows; ++y) {
    IntLanes left, right;
    rows.load(y);
    rows.template sample<0>(left);
    rows.template sample<kLanes>(right);
    PatchLanes::storeHalfRow(left, right, strip.row(y));
  }
}

/// One number per sample, i.e. per window side by side, and one spare.
constexpr int kLanesOfSamples = kMaximumWindows;
using Samples = WindowSumLanes;
static_assert(kNccSamples <= kLanesOfSamples && Strip<0>::kStride >= kNccColumns + kLanesOfSamples - 1);

inline void widen(const Samples& samples, int first, DoubleLanes& numbers) {
  using Some = std::int32_t __attribute__((vector_size(4 * kDoubleLanes), may_alias));
  numbers =
      __builtin_convertvector(reinterpret_cast<const Some*>(&samples)[first / kDoubleLanes], DoubleLanes);
}

constexpr double kMinimumVariance =
    0.25 * kGreyUnits * kGreyUnits;  // smallest variance of a window with texture

/// Squared correlations with their sign, so that roots are computed only for peaks.
using SquaredCorrelations = std::array<double, kLanesOfSamples>;

/// Correlates the windows of the strip with the template.
template <int Rows>
void correlate(const NccTemplate& left, const Strip<Rows>& strip,
               std::array<SquaredCorrelations, 2 * Rows + 1>& correlations) {
  for (int row = 0; row <= 2 * Rows; ++row) {
    Samples sums, squares, products;
    PatchLanes::sumWindows<kNccSamples, kNccRows, Strip<Rows>::kStride>(left.value, strip.row(row), products,
                                                                        sums, squares);
    for (int first = 0; first < kLanesOfSamples; first += kDoubleLanes) {
      DoubleLanes sum, square, product;
      widen(sums, first, sum);
      widen(squares, first, square);
      widen(products, first, product);
      product -= left.mean * sum;
      const DoubleLanes variance = square - sum * sum / (1.0 * kNccSize);
      DoubleLanes squared = product * (product < 0.0 ? -product : product) / variance;
      squared = variance > kMinimumVariance ? squared : DoubleLanes{};
      std::memcpy(&correlations[row][first], &squared, sizeof squared);
    }
  }
}

template <int Rows>
NccPeak highestPeak(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& centre) {
  Strip<Rows> strip;
  sampleStrip<Rows>(right, centre, strip);
  std::array<SquaredCorrelations, 2 * Rows + 1> correlations;
  correlate<Rows>(left, strip, correlations);
  const auto root = [&left](double squared) {
    return std::copysign(std::sqrt(std::abs(squared)), squared) / left.norm;
  };
  NccPeak best;
  for (int row = 0; row <= 2 * Rows; ++row) {
    const SquaredCorrelations& squared = correlations[row];
    for (int sample = 1; sample < kNccSamples - 1; ++sample) {
      const double middle = squared[sample];
      if (middle <= 0.0 || middle < squared[sample - 1] || middle < squared[sample + 1]) continue;
      // Compares peaks and not samples: between two columns the samples of the right row may be lower than
      // those of a wrong row whose texture happens to meet a column.
      NccPeak peak{row - Rows, sample - (kNccRadius + 1), root(squared[sample - 1]), root(middle),
                   root(squared[sample + 1])};
      peak.height = sinusoidalHeight(peak.left, peak.middle, peak.right);
      if (peak.height > best.height) best = peak;
    }
  }
  return best;
}

}  // namespace ncc_detail

/// Finds the highest peak of the template's normalised cross-correlation with windows of the right image at
/// most kNccRadius columns and `rows` <= 3 rows away from `centre`.
inline NccPeak highestPeak(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& centre,
                           int rows) {
  switch (rows) {
    case 0:
      return ncc_detail::highestPeak<0>(left, right, centre);
    case 1:
      return ncc_detail::highestPeak<1>(left, right, centre);
    case 2:
      return ncc_detail::highestPeak<2>(left, right, centre);
    default:
      return ncc_detail::highestPeak<3>(left, right, centre);
  }
}

}  // namespace cartvo::vo
