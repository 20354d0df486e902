// From the left image to the right one, for one feature.
#include "vo_core/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "vo_core/patch.hpp"
#include "vo_core/subpixel_fit.hpp"

namespace cartvo {
namespace {

constexpr int kCandidates = 3;    // of the coarsest level
constexpr int kSearchRadius = 3;  // px at each finer level
constexpr int kSadColumns = 16, kSadRows = 9;
constexpr int kNccColumns = 15, kNccRows = 9;
constexpr int kNccRadius = 2;           // px around the disparity of the SAD
constexpr int kDistinct = 3;            // px; candidates closer than this are the same peak
constexpr double kLeastColumns = 0.05;  // px per px of disparity
constexpr int kNoRival = 2;             // times the least difference: a candidate that is none
constexpr double kNoiseFloor = 0.002;   // of 1 - correlation: differences below are noise

struct LevelPixel {
  int x = 0, y = 0;
};

bool contains(const PyramidLevel& level, const LevelPixel& pixel) {
  return pixel.x >= 0 && pixel.y >= 0 && pixel.x < level.width() && pixel.y < level.height();
}

/// Compares a window of the left image with windows of the right one.
class SadWindow {
 public:
  SadWindow(const PyramidLevel& left, const LevelPixel& pixel) {
    for (int row = 0; row < kSadRows; ++row)
      std::memcpy(&rows_[row], left.at(pixel.x - kSadColumns / 2, pixel.y - kSadRows / 2 + row), kSadColumns);
  }

  int sumOfAbsoluteDifferences(const PyramidLevel& right, const LevelPixel& pixel) const {
    const std::uint8_t* from = right.at(pixel.x - kSadColumns / 2, pixel.y - kSadRows / 2);
#ifdef __SSE2__
    __m128i sum = _mm_setzero_si128();
#pragma GCC unroll 9
    for (int row = 0; row < kSadRows; ++row, from += right.stride())
      sum = _mm_add_epi32(sum, _mm_sad_epu8(rows_[row], _mm_loadu_si128(reinterpret_cast<const Row*>(from))));
    return _mm_cvtsi128_si32(sum) + _mm_extract_epi16(sum, 4);
#else
    int sum = 0;
    for (int row = 0; row < kSadRows; ++row, from += right.stride())
      for (int column = 0; column < kSadColumns; ++column)
        sum += std::abs(rows_[row][column] - from[column]);
    return sum;
#endif
  }

 private:
#ifdef __SSE2__  // whose sum of sixteen absolute differences GCC does not always find by itself
  using Row = __m128i;
#else
  using Row = std::array<std::uint8_t, kSadColumns>;
#endif
  Row rows_[kSadRows];
};

struct Candidates {
  std::array<int, kCandidates> disparity{};
  int count = 0;
};

/// The nearest whole number; of what is above -kRoundingBias, as all pixels are.
int rounded(double value) {
  constexpr int kRoundingBias = 1 << 20;
  return static_cast<int>(value + (kRoundingBias + 0.5)) - kRoundingBias;
}

LevelPixel pixelAt(const PyramidLevel& level, const Eigen::Vector2d& pixel, int index) {
  const double scale = 1.0 / (1 << index);
  return {std::min(rounded(pixel.x() * scale), level.width() - 1),
          std::min(rounded(pixel.y() * scale), level.height() - 1)};
}

/// The line of one left pixel in one level.
class LevelLine {
 public:
  LevelLine(const LevelPixel& pixel, const EpipolarLine& line, int index)
      : pixel_(pixel),
        infinity_(line.at_infinity / (1 << index)),
        slope_(line.per_disparity - Eigen::Vector2d::UnitX()) {}

  LevelPixel at(int disparity) const {
    return {pixel_.x + rounded(infinity_.x() + disparity * slope_.x()),
            pixel_.y + rounded(infinity_.y() + disparity * slope_.y())};
  }

 private:
  LevelPixel pixel_;
  Eigen::Vector2d infinity_, slope_;
};

/// The deepest local minima of the sum of absolute differences over the whole range of disparity.
Candidates searchCoarsest(const SadWindow& left, const PyramidLevel& right, const LevelLine& line,
                          int maximum_disparity) {
  constexpr int kFar = 1 << 30;
  std::array<int, kCandidates> best_sad;
  best_sad.fill(kFar);
  Candidates candidates;
  const auto difference = [&](int disparity) {
    const LevelPixel at = line.at(disparity);
    return disparity <= maximum_disparity && contains(right, at) ? left.sumOfAbsoluteDifferences(right, at)
                                                                 : kFar;
  };
  int previous = kFar;
  int current = difference(0);
  for (int disparity = 0; disparity <= maximum_disparity; ++disparity) {
    const int next = difference(disparity + 1);
    if (current <= previous && current < next && current < best_sad[kCandidates - 1]) {
      int slot = kCandidates - 1;
      for (; slot > 0 && current < best_sad[slot - 1]; --slot) {
        best_sad[slot] = best_sad[slot - 1];
        candidates.disparity[slot] = candidates.disparity[slot - 1];
      }
      best_sad[slot] = current;
      candidates.disparity[slot] = disparity;
      candidates.count = std::min(candidates.count + 1, kCandidates);
    }
    previous = current;
    current = next;
  }
  return candidates;
}

/// The best disparity around one, and its sum of absolute differences.
int searchAround(const SadWindow& left, const PyramidLevel& right, const LevelLine& line, int disparity,
                 int& best_sad) {
  int best = disparity;
  best_sad = 1 << 30;
  for (int trial = disparity - kSearchRadius; trial <= disparity + kSearchRadius; ++trial) {
    const LevelPixel at = line.at(trial);
    if (!contains(right, at)) continue;
    const int sad = left.sumOfAbsoluteDifferences(right, at);
    if (sad < best_sad) {
      best_sad = sad;
      best = trial;
    }
  }
  return best;
}

constexpr int kMostRows = 3;                     // of StereoSettings::rows
constexpr int kNccSamples = 2 * kNccRadius + 3;  // one more on each side, for the sub-pixel fit
using NccPatch = Patch<kNccColumns, kNccRows>;
using NccStrip = Patch<kNccColumns + kNccSamples - 1, kNccRows + 2 * kMostRows>;

/// One number for each sample, which are windows side by side, and one more.
using Samples = float __attribute__((vector_size(32), may_alias));
constexpr int kSampleLanes = 8;
static_assert(kNccSamples <= kSampleLanes && NccStrip::kStride >= kNccColumns + kSampleLanes - 1);

/// The left patch with its mean removed, its mean and its norm.
struct NccTemplate {
  NccPatch centred;
  float mean = 0.0F;
  double norm = 0.0;
};

void makeTemplate(const PyramidLevel& level, const Eigen::Vector2d& pixel, NccTemplate& out) {
  samplePatch(level, pixel, out.centred);
  out.mean = removeMean(out.centred);
  out.norm = std::sqrt(sumOfProducts(out.centred, out.centred));
}

/// By sample; of squared correlations with their sign, so that no root is drawn of those that are no peak.
using SquaredCorrelations = std::array<double, kSampleLanes>;

/// As they lie anywhere in a row.
using SamplesInRow = float __attribute__((vector_size(32), aligned(4), may_alias));
const SamplesInRow& samplesFrom(const float* row) {
  return *reinterpret_cast<const SamplesInRow*>(row);
}

/// Sums over the window's rows, by column of the strip.
struct ColumnSums {
  alignas(64) std::array<float, NccStrip::kStride> values, squares;
};

void sumColumns(const NccStrip& strip, int first_row, ColumnSums& sums) {
  sums.values.fill(0.0F);
  sums.squares.fill(0.0F);
  for (int y = first_row; y < first_row + kNccRows; ++y) {
    const float* values = strip.row(y);
    for (int x = 0; x < NccStrip::kStride; ++x) {
      sums.values[x] += values[x];
      sums.squares[x] += values[x] * values[x];
    }
  }
}

/// Sums over the window's columns, by sample.
void sumSamples(const std::array<float, NccStrip::kStride>& columns, Samples& sums) {
  sums = Samples{};
  for (int x = 0; x < kNccColumns; ++x)
    sums += samplesFrom(&columns[x]);
}

/// The samples' sums of products with the template, in the rows from -Rows to Rows.
template <int Rows>
void sumProducts(const NccTemplate& left, const NccStrip& strip, Samples (&products)[2 * Rows + 1]) {
  constexpr int kCount = 2 * Rows + 1;
  Samples even[kCount] = {}, odd[kCount] = {};  // two sums of each, so that they need not wait for each other
  for (int x = 0; x < kNccColumns; ++x) {
#pragma GCC unroll 16
    for (int y = 0; y < kNccRows + 2 * Rows; ++y) {
      const Samples right = samplesFrom(strip.row(kMostRows - Rows + y) + x);
#pragma GCC unroll 8
      for (int row = 0; row < kCount; ++row)
        if (y >= row && y < row + kNccRows)
          (y % 2 == 0 ? even : odd)[row] += left.centred.row(y - row)[x] * right;
    }
  }
  for (int row = 0; row < kCount; ++row)
    products[row] = even[row] + odd[row];
}

/// Of the windows of the strip that lie in the rows from -Rows to Rows, with the template.
template <int Rows>
void correlate(const NccTemplate& left, NccStrip& strip, SquaredCorrelations* correlations) {
  for (int y = kMostRows - Rows; y < kMostRows + Rows + kNccRows; ++y)
    for (int x = 0; x < NccStrip::kStride; ++x)
      strip.row(y)[x] -= left.mean;  // about equal to the right mean, which saves digits
  constexpr int kCount = 2 * Rows + 1;
  ColumnSums columns[kCount];
  for (int row = 0; row < kCount; ++row)
    sumColumns(strip, kMostRows - Rows + row, columns[row]);
  Samples products[kCount];
  sumProducts<Rows>(left, strip, products);
  for (int row = 0; row < kCount; ++row) {
    Samples sums, squares;
    sumSamples(columns[row].values, sums);
    sumSamples(columns[row].squares, squares);
    for (int sample = 0; sample < kSampleLanes; ++sample) {
      const auto sum = static_cast<double>(sums[sample]);
      const auto product = static_cast<double>(products[row][sample]);
      const double variance = static_cast<double>(squares[sample]) - sum * sum / NccPatch::kSize;
      correlations[row][sample] = variance > 1.0 ? product * std::abs(product) / variance : 0.0;
    }
  }
}

void correlate(const NccTemplate& left, NccStrip& strip, int rows, SquaredCorrelations* correlations) {
  switch (rows) {
    case 0:
      return correlate<0>(left, strip, correlations);
    case 1:
      return correlate<1>(left, strip, correlations);
    case 2:
      return correlate<2>(left, strip, correlations);
    default:
      return correlate<kMostRows>(left, strip, correlations);
  }
}

/// Three neighbouring correlations, the greatest in the middle.
struct NccPeak {
  int row = 0, sample = 0;
  double left = 0.0, middle = 0.0, right = 0.0;
  double height = 0.0;
};

NccPeak highestPeak(const SquaredCorrelations* correlations, int rows, double norm) {
  const auto root = [norm](double squared) {
    return std::copysign(std::sqrt(std::abs(squared)), squared) / norm;
  };
  NccPeak best;
  for (int row = 0; row <= 2 * rows; ++row) {
    const SquaredCorrelations& squared = correlations[row];
    for (int sample = 1; sample < kNccSamples - 1; ++sample) {
      const double middle = squared[sample];
      if (middle <= 0.0 || middle < squared[sample - 1] || middle < squared[sample + 1]) continue;
      // Peaks are compared, not samples: between two columns the right row's samples may be lower than those
      // of a wrong row whose texture happens to meet a column.
      NccPeak peak{row - rows, sample, root(squared[sample - 1]), root(middle), root(squared[sample + 1])};
      peak.height = sinusoidalHeight(peak.left, peak.middle, peak.right);
      if (peak.height > best.height) best = peak;
    }
  }
  return best;
}

/// The best correlation around an integer disparity and its sub-pixel place. Left and right are sampled at
/// the same fractions of a pixel: the same blur in both, so that interpolation biases nothing.
StereoMatch correlateAround(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& pixel,
                            const EpipolarLine& line, int disparity, int rows) {
  StereoMatch best;
  const Eigen::Vector2d centre = line.at(pixel, disparity);
  if (!right.contains(centre)) return best;
  NccStrip strip;
  samplePatch(right, centre, strip);
  std::array<SquaredCorrelations, 2 * kMostRows + 1> correlations;
  correlate(left, strip, rows, correlations.data());
  const NccPeak peak = highestPeak(correlations.data(), rows, left.norm);
  if (peak.height <= 0.0) return best;
  // Near the epipole a column is many disparities.
  const double per_column = 1.0 / std::max(1.0 - line.per_disparity.x(), kLeastColumns);
  const double columns =
      peak.sample - (kNccRadius + 1) + sinusoidalOffset(peak.left, peak.middle, peak.right);
  best.correlation = peak.height;
  best.row_offset = peak.row;
  best.disparity = disparity - columns * per_column;  // to the right is less disparity
  best.right = line.at(pixel, best.disparity) + Eigen::Vector2d(0.0, peak.row);
  return best;
}

}  // namespace

CARTVO_VECTOR_CLONES
std::optional<StereoMatch> matchStereo(const ImagePyramid& left_image, const ImagePyramid& right_image,
                                       const Eigen::Vector2d& left, const StereoSettings& settings,
                                       const EpipolarLine& line) {
  if (!left_image.grey.front().contains(left)) return std::nullopt;
  if (left_image.dog.empty()) return std::nullopt;
  const int coarsest = kFinestDog + static_cast<int>(left_image.dog.size()) - 1;
  const PyramidLevel& coarse = left_image.dog.back();
  const LevelPixel coarse_pixel = pixelAt(coarse, left, coarsest);
  Candidates candidates =
      searchCoarsest(SadWindow(coarse, coarse_pixel), right_image.dog.back(),
                     LevelLine(coarse_pixel, line, coarsest), (settings.maximum_disparity >> coarsest) + 1);
  if (candidates.count == 0) return std::nullopt;
  std::array<int, kCandidates> difference{};
  for (int level = coarsest - 1; level >= kFinestDog; --level) {
    const PyramidLevel& left_level = left_image.dog[level - kFinestDog];
    const LevelPixel pixel = pixelAt(left_level, left, level);
    const SadWindow window(left_level, pixel);
    const LevelLine level_line(pixel, line, level);
    for (int i = 0; i < candidates.count; ++i)
      candidates.disparity[i] = searchAround(window, right_image.dog[level - kFinestDog], level_line,
                                             2 * candidates.disparity[i], difference[i]);
  }
  const int least = *std::min_element(difference.begin(), difference.begin() + candidates.count);

  NccTemplate patch;
  makeTemplate(left_image.grey.front(), left, patch);
  if (patch.norm < 1.0) return std::nullopt;
  StereoMatch best;
  double rival = 0.0;  // correlation of the best candidate elsewhere
  for (int i = 0; i < candidates.count; ++i) {
    if (difference[i] / kNoRival > least) continue;
    const StereoMatch match = correlateAround(patch, right_image.grey.front(), left, line,
                                              candidates.disparity[i] << kFinestDog, settings.rows);
    if (match.correlation <= 0.0) continue;
    const bool elsewhere = std::abs(match.disparity - best.disparity) > kDistinct;
    if (match.correlation > best.correlation) {
      if (elsewhere) rival = best.correlation;
      best = match;
    } else if (elsewhere) {
      rival = std::max(rival, match.correlation);
    }
  }
  if (best.correlation < settings.minimum_correlation) return std::nullopt;
  if (best.disparity < settings.minimum_disparity || best.disparity > settings.maximum_disparity)
    return std::nullopt;
  if (1.0 - best.correlation > settings.uniqueness * (1.0 - rival) - kNoiseFloor) return std::nullopt;
  return best;
}

}  // namespace cartvo
