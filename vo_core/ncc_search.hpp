#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstring>

#include "vo_core/double_lanes.hpp"
#include "vo_core/patch.hpp"
#include "vo_core/subpixel_fit.hpp"

namespace cartvo {

constexpr int kNccColumns = 15, kNccRows = 9;    ///< px, of the windows that are correlated
constexpr int kNccRadius = 2;                    ///< px to the left and right in which a peak may lie
constexpr int kNccSamples = 2 * kNccRadius + 3;  ///< one more on each side, for the sub-pixel fit

/// A left patch with its mean removed, its mean and its norm.
struct NccTemplate {
  Patch<kNccColumns, kNccRows> centred;
  float mean = 0.0F;
  double norm = 0.0;
};

template <typename Processor>
void makeTemplate(const PyramidLevel& level, const Eigen::Vector2d& pixel, NccTemplate& out) {
  samplePatch<Processor>(level, pixel, out.centred);
  out.mean = removeMean(out.centred);
  out.norm = std::sqrt(sumOfProducts(out.centred, out.centred));
}

/// Three neighbouring correlations, the greatest in the middle.
struct NccPeak {
  int row = 0, middle_column = 0;  ///< px from where it was looked for
  double left = 0.0, middle = 0.0, right = 0.0;
  double height = 0.0;  ///< 0: there is none

  double column() const { return middle_column + sinusoidalOffset(left, middle, right); }
};

namespace ncc_detail {

/// What the windows around a place cover.
template <int Rows>
using Strip = Patch<kNccColumns + kNccSamples - 1, kNccRows + 2 * Rows>;
using StripRow = Strip<0>;

/// One number for each sample, which are windows side by side, and one more.
constexpr int kLanesOfSamples = 8;
using Samples = float __attribute__((vector_size(4 * kLanesOfSamples), may_alias));
static_assert(kNccSamples <= kLanesOfSamples && StripRow::kStride >= kNccColumns + kLanesOfSamples - 1);

/// As they lie anywhere in a row.
using SamplesInRow = float __attribute__((vector_size(4 * kLanesOfSamples), aligned(4), may_alias));
inline const SamplesInRow& samplesFrom(const float* row) {
  return *reinterpret_cast<const SamplesInRow*>(row);
}

/// Sums over a window's rows, by column of the strip.
struct ColumnSums {
  static constexpr int kBlocks = StripRow::kBlocks;
  Lanes values[kBlocks], squares[kBlocks];

  template <int Rows>
  void add(const Strip<Rows>& strip, int row) {
#pragma GCC unroll 4
    for (int block = 0; block < kBlocks; ++block) {
      const Lanes& value = strip.lanes(row, block);
      values[block] += value;
      squares[block] += value * value;
    }
  }
};

/// Those of the windows from the strip's first rows down to its last ones.
template <int Rows>
void sumColumns(const Strip<Rows>& strip, std::array<ColumnSums, 2 * Rows + 1>& windows) {
  ColumnSums common{};  // of the rows that lie in all windows
  for (int y = 2 * Rows; y < kNccRows; ++y)
    common.add<Rows>(strip, y);
#pragma GCC unroll 8
  for (int row = 0; row <= 2 * Rows; ++row) {
    windows[row] = common;
    for (int y = row; y < 2 * Rows; ++y)
      windows[row].template add<Rows>(strip, y);
    for (int y = kNccRows; y < row + kNccRows; ++y)
      windows[row].template add<Rows>(strip, y);
  }
}

/// Sums over the window's columns, by sample.
inline void sumSamples(const Lanes* columns, Samples& sums) {
  const auto* column = reinterpret_cast<const float*>(columns);
  sums = Samples{};
#pragma GCC unroll 15
  for (int x = 0; x < kNccColumns; ++x)
    sums += samplesFrom(column + x);
}

/// The samples' sums of products with the template.
template <int Rows>
void sumProducts(const NccTemplate& left, const Strip<Rows>& strip, Samples (&products)[2 * Rows + 1]) {
  constexpr int kCount = 2 * Rows + 1;
  Samples even[kCount] = {}, odd[kCount] = {};  // two sums of each, so that they need not wait for each other
  for (int x = 0; x < kNccColumns; ++x) {
#pragma GCC unroll 16
    for (int y = 0; y < kNccRows + 2 * Rows; ++y) {
      const Samples right = samplesFrom(strip.row(y) + x);
#pragma GCC unroll 8
      for (int row = 0; row < kCount; ++row)
        if (y >= row && y < row + kNccRows)
          (y % 2 == 0 ? even : odd)[row] += left.centred.row(y - row)[x] * right;
    }
  }
  for (int row = 0; row < kCount; ++row)
    products[row] = even[row] + odd[row];
}

inline void widen(const Samples& samples, int first, DoubleLanes& numbers) {
  for (int i = 0; i < kDoubleLanes; ++i)
    numbers[i] = static_cast<double>(samples[first + i]);
}

/// Squared correlations with their sign, so that no root is drawn of those that are no peak.
using SquaredCorrelations = std::array<double, kLanesOfSamples>;

/// Of the windows of the strip with the template.
template <int Rows>
void correlate(const NccTemplate& left, Strip<Rows>& strip,
               std::array<SquaredCorrelations, 2 * Rows + 1>& correlations) {
  for (int y = 0; y < kNccRows + 2 * Rows; ++y)
    for (int block = 0; block < StripRow::kBlocks; ++block)
      strip.lanes(y, block) -= left.mean;  // about equal to the right mean, which saves digits
  constexpr int kCount = 2 * Rows + 1;
  std::array<ColumnSums, kCount> columns;
  sumColumns<Rows>(strip, columns);
  Samples products[kCount];
  sumProducts<Rows>(left, strip, products);
  for (int row = 0; row < kCount; ++row) {
    Samples sums, squares;
    sumSamples(columns[row].values, sums);
    sumSamples(columns[row].squares, squares);
    for (int first = 0; first < kLanesOfSamples; first += kDoubleLanes) {
      DoubleLanes sum, square, product;
      widen(sums, first, sum);
      widen(squares, first, square);
      widen(products[row], first, product);
      const DoubleLanes variance = square - sum * sum / (1.0 * kNccColumns * kNccRows);
      DoubleLanes squared = product * (product < 0.0 ? -product : product) / variance;
      squared = variance > 1.0 ? squared : DoubleLanes{};
      std::memcpy(&correlations[row][first], &squared, sizeof squared);
    }
  }
}

template <typename Processor, int Rows>
NccPeak highestPeak(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& centre) {
  Strip<Rows> strip;
  samplePatch<Processor>(right, centre, strip);
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
      // Peaks are compared, not samples: between two columns the right row's samples may be lower than those
      // of a wrong row whose texture happens to meet a column.
      NccPeak peak{row - Rows, sample - (kNccRadius + 1), root(squared[sample - 1]), root(middle),
                   root(squared[sample + 1])};
      peak.height = sinusoidalHeight(peak.left, peak.middle, peak.right);
      if (peak.height > best.height) best = peak;
    }
  }
  return best;
}

}  // namespace ncc_detail

/// The highest peak of the template's normalised cross-correlation with windows of the right image, around
/// those that are at most kNccRadius columns and `rows` <= 3 rows away from `centre`.
template <typename Processor>
NccPeak highestPeak(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& centre,
                    int rows) {
  switch (rows) {
    case 0:
      return ncc_detail::highestPeak<Processor, 0>(left, right, centre);
    case 1:
      return ncc_detail::highestPeak<Processor, 1>(left, right, centre);
    case 2:
      return ncc_detail::highestPeak<Processor, 2>(left, right, centre);
    default:
      return ncc_detail::highestPeak<Processor, 3>(left, right, centre);
  }
}

}  // namespace cartvo
