// From the left image to the right one, for one feature.
#include "vo_core/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "vo_core/patch.hpp"
#include "vo_core/subpixel_fit.hpp"

namespace cartvo {
namespace {

constexpr int kCandidates = 3;    // of the coarsest level
constexpr int kSearchRadius = 3;  // px at each finer level
constexpr int kSadColumns = 16, kSadRows = 9;
constexpr int kNccColumns = 15, kNccRows = 9;
constexpr int kNccRadius = 2;          // px around the disparity of the SAD
constexpr int kDistinct = 3;           // px; candidates closer than this are the same peak
constexpr double kNoiseFloor = 0.002;  // of 1 - correlation: differences below are noise

int sumOfAbsoluteDifferences(const PyramidLevel& left, int left_x, const PyramidLevel& right, int right_x,
                             int y) {
  int sum = 0;
  for (int row = -kSadRows / 2; row <= kSadRows / 2; ++row) {
    const unsigned char* a = left.at<unsigned char>(left_x - kSadColumns / 2, y + row);
    const unsigned char* b = right.at<unsigned char>(right_x - kSadColumns / 2, y + row);
    for (int column = 0; column < kSadColumns; ++column)
      sum += std::abs(a[column] - b[column]);
  }
  return sum;
}

struct Candidates {
  std::array<int, kCandidates> disparity{};
  int count = 0;
};

struct LevelPixel {
  int x = 0, y = 0;
};

LevelPixel pixelAt(const PyramidLevel& level, const Eigen::Vector2d& pixel, int index) {
  const double scale = 1.0 / (1 << index);
  return {std::min(static_cast<int>(std::lround(pixel.x() * scale)), level.width() - 1),
          std::min(static_cast<int>(std::lround(pixel.y() * scale)), level.height() - 1)};
}

/// The deepest local minima of the sum of absolute differences over the whole range of disparity.
Candidates searchCoarsest(const PyramidLevel& left, const PyramidLevel& right, const LevelPixel& pixel,
                          int maximum_disparity) {
  const int range = std::min(maximum_disparity, pixel.x);
  constexpr int kFar = 1 << 30;
  std::array<int, kCandidates> best_sad;
  best_sad.fill(kFar);
  Candidates candidates;
  int previous = kFar;
  int current = sumOfAbsoluteDifferences(left, pixel.x, right, pixel.x, pixel.y);
  for (int disparity = 0; disparity <= range; ++disparity) {
    const int next = disparity == range
                         ? kFar
                         : sumOfAbsoluteDifferences(left, pixel.x, right, pixel.x - disparity - 1, pixel.y);
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

int searchAround(const PyramidLevel& left, const PyramidLevel& right, const LevelPixel& pixel,
                 int disparity) {
  int best = disparity;
  int best_sad = 1 << 30;
  for (int trial = disparity - kSearchRadius; trial <= disparity + kSearchRadius; ++trial) {
    const int right_x = pixel.x - trial;
    if (right_x < 0 || right_x >= right.width()) continue;
    const int sad = sumOfAbsoluteDifferences(left, pixel.x, right, right_x, pixel.y);
    if (sad < best_sad) {
      best_sad = sad;
      best = trial;
    }
  }
  return best;
}

using NccPatch = Patch<kNccColumns, kNccRows>;
using NccStrip = Patch<kNccColumns + 2 * (kNccRadius + 1), kNccRows + 2 * 3>;  // room for rows <= 3

/// The left patch with its mean removed, and its norm.
struct NccTemplate {
  NccPatch centred;
  double norm = 0.0;
};

NccTemplate makeTemplate(const PyramidLevel& level, const Eigen::Vector2d& pixel) {
  NccTemplate result;
  NccPatch& patch = result.centred;
  samplePatch(level, pixel, patch);
  double sum = 0.0;
  for (int y = 0; y < kNccRows; ++y)
    for (int x = 0; x < kNccColumns; ++x)
      sum += patch.row(y)[x];
  const float mean = static_cast<float>(sum / (kNccRows * kNccColumns));
  double square = 0.0;
  for (int y = 0; y < kNccRows; ++y) {
    for (int x = 0; x < kNccColumns; ++x) {
      float& value = patch.row(y)[x];
      value -= mean;
      square += static_cast<double>(value) * value;
    }
    for (int x = kNccColumns; x < NccPatch::kStride; ++x)
      patch.row(y)[x] = 0.0F;
  }
  result.norm = std::sqrt(square);
  return result;
}

/// Normalised cross-correlation of the template with the strip's window whose upper left corner is (x0, y0).
double correlate(const NccTemplate& left, const NccStrip& strip, int x0, int y0) {
  float column_product[NccPatch::kStride] = {};
  float column_sum[NccPatch::kStride] = {};
  float column_square[NccPatch::kStride] = {};
  for (int y = 0; y < kNccRows; ++y) {
    const float* a = left.centred.row(y);
    const float* b = strip.row(y0 + y) + x0;
    for (int x = 0; x < kNccColumns; ++x) {
      column_product[x] += a[x] * b[x];
      column_sum[x] += b[x];
      column_square[x] += b[x] * b[x];
    }
  }
  double product = 0.0;
  double sum = 0.0;
  double square = 0.0;
  for (int x = 0; x < kNccColumns; ++x) {
    product += column_product[x];
    sum += column_sum[x];
    square += column_square[x];
  }
  const double variance = square - sum * sum / (kNccRows * kNccColumns);
  return variance > 1.0 ? product / (left.norm * std::sqrt(variance)) : 0.0;
}

/// The best correlation around an integer disparity and its sub-pixel place. Left and right are sampled at
/// the same fractions of a pixel: the same blur in both, so that interpolation biases nothing.
StereoMatch correlateAround(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& pixel,
                            int disparity, int rows) {
  StereoMatch best;
  const Eigen::Vector2d centre(pixel.x() - disparity, pixel.y());
  if (!right.contains(centre)) return best;
  NccStrip strip;
  samplePatch(right, centre, strip);
  constexpr int kSamples = 2 * kNccRadius + 3;  // one more on each side, for the sub-pixel fit
  for (int row = -rows; row <= rows; ++row) {
    std::array<double, kSamples> correlation{};
    for (int sample = 0; sample < kSamples; ++sample)
      correlation[sample] = correlate(left, strip, sample, 3 + row);
    for (int sample = 1; sample < kSamples - 1; ++sample) {
      const double middle = correlation[sample];
      if (middle <= 0.0 || middle < correlation[sample - 1] || middle < correlation[sample + 1]) continue;
      // Peaks are compared, not samples: between two columns the right row's samples may be lower than those
      // of a wrong row whose texture happens to meet a column.
      const Peak peak = sinusoidalPeak(correlation[sample - 1], middle, correlation[sample + 1]);
      if (peak.height <= best.correlation) continue;
      best.correlation = peak.height;
      best.row_offset = row;
      best.disparity =
          disparity - (sample - (kNccRadius + 1) + peak.offset);  // to the right is less disparity
    }
  }
  return best;
}

}  // namespace

CARTVO_VECTOR_CLONES
std::optional<StereoMatch> matchStereo(const ImagePyramid& left_image, const ImagePyramid& right_image,
                                       const Eigen::Vector2d& left, const StereoSettings& settings) {
  if (!left_image.grey.front().contains(left)) return std::nullopt;
  const int coarsest = static_cast<int>(left_image.dog.size()) - 1;
  const PyramidLevel& coarse = left_image.dog[coarsest];
  Candidates candidates = searchCoarsest(coarse, right_image.dog[coarsest], pixelAt(coarse, left, coarsest),
                                         (settings.maximum_disparity >> coarsest) + 1);
  for (int level = coarsest - 1; level >= 0; --level) {
    const LevelPixel pixel = pixelAt(left_image.dog[level], left, level);
    for (int i = 0; i < candidates.count; ++i)
      candidates.disparity[i] =
          searchAround(left_image.dog[level], right_image.dog[level], pixel, 2 * candidates.disparity[i]);
  }

  const NccTemplate patch = makeTemplate(left_image.grey.front(), left);
  if (patch.norm < 1.0) return std::nullopt;
  StereoMatch best;
  double rival = 0.0;  // correlation of the best candidate elsewhere
  for (int i = 0; i < candidates.count; ++i) {
    const StereoMatch match =
        correlateAround(patch, right_image.grey.front(), left, candidates.disparity[i], settings.rows);
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
