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

int sumOfAbsoluteDifferences(const PyramidLevel& left, const LevelPixel& left_pixel,
                             const PyramidLevel& right, const LevelPixel& right_pixel) {
  int sum = 0;
  for (int row = -kSadRows / 2; row <= kSadRows / 2; ++row) {
    const unsigned char* a = left.at(left_pixel.x - kSadColumns / 2, left_pixel.y + row);
    const unsigned char* b = right.at(right_pixel.x - kSadColumns / 2, right_pixel.y + row);
    for (int column = 0; column < kSadColumns; ++column)
      sum += std::abs(a[column] - b[column]);
  }
  return sum;
}

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
Candidates searchCoarsest(const PyramidLevel& left, const PyramidLevel& right, const LevelPixel& pixel,
                          const LevelLine& line, int maximum_disparity) {
  constexpr int kFar = 1 << 30;
  std::array<int, kCandidates> best_sad;
  best_sad.fill(kFar);
  Candidates candidates;
  const auto difference = [&](int disparity) {
    const LevelPixel at = line.at(disparity);
    return disparity <= maximum_disparity && contains(right, at)
               ? sumOfAbsoluteDifferences(left, pixel, right, at)
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
int searchAround(const PyramidLevel& left, const PyramidLevel& right, const LevelPixel& pixel,
                 const LevelLine& line, int disparity, int& best_sad) {
  int best = disparity;
  best_sad = 1 << 30;
  for (int trial = disparity - kSearchRadius; trial <= disparity + kSearchRadius; ++trial) {
    const LevelPixel at = line.at(trial);
    if (!contains(right, at)) continue;
    const int sad = sumOfAbsoluteDifferences(left, pixel, right, at);
    if (sad < best_sad) {
      best_sad = sad;
      best = trial;
    }
  }
  return best;
}

using NccPatch = Patch<kNccColumns, kNccRows>;
using NccStrip = Patch<kNccColumns + 2 * (kNccRadius + 1), kNccRows + 2 * 3>;  // room for rows <= 3
constexpr Patch<kNccColumns, 1> kMask = NccPatch::mask();

/// The left patch with its mean removed, zero in the padding, its mean and its norm.
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

/// Normalised cross-correlation of the template with the strip's window whose upper left corner is (x0, y0).
double correlate(const NccTemplate& left, const NccStrip& strip, int x0, int y0) {
  Lanes products{}, sums{}, squares{};
  for (int y = 0; y < kNccRows; ++y) {
    for (int block = 0; block < NccPatch::kBlocks; ++block) {
      Lanes value;
      std::memcpy(&value, strip.row(y0 + y) + x0 + kLanes * block, sizeof value);
      const Lanes masked = (value - left.mean) * kMask.lanes(0, block);
      products += left.centred.lanes(y, block) * masked;
      sums += masked;
      squares += masked * masked;
    }
  }
  const double sum = sumOf(sums);
  const double variance = sumOf(squares) - sum * sum / NccPatch::kSize;
  return variance > 1.0 ? sumOf(products) / (left.norm * std::sqrt(variance)) : 0.0;
}

/// The best correlation around an integer disparity and its sub-pixel place. Left and right are sampled at
/// the same fractions of a pixel: the same blur in both, so that interpolation biases nothing.
StereoMatch correlateAround(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& pixel,
                            const EpipolarLine& line, int disparity, int rows) {
  StereoMatch best;
  const Eigen::Vector2d centre = line.at(pixel, disparity);
  // Near the epipole a column is many disparities.
  const double per_column = 1.0 / std::max(1.0 - line.per_disparity.x(), kLeastColumns);
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
      const double columns = sample - (kNccRadius + 1) + peak.offset;
      best.disparity = disparity - columns * per_column;  // to the right is less disparity
      best.right = line.at(pixel, best.disparity) + Eigen::Vector2d(0.0, row);
    }
  }
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
      searchCoarsest(coarse, right_image.dog.back(), coarse_pixel, LevelLine(coarse_pixel, line, coarsest),
                     (settings.maximum_disparity >> coarsest) + 1);
  if (candidates.count == 0) return std::nullopt;
  std::array<int, kCandidates> difference{};
  for (int level = coarsest - 1; level >= kFinestDog; --level) {
    const PyramidLevel& left_level = left_image.dog[level - kFinestDog];
    const LevelPixel pixel = pixelAt(left_level, left, level);
    const LevelLine level_line(pixel, line, level);
    for (int i = 0; i < candidates.count; ++i)
      candidates.disparity[i] = searchAround(left_level, right_image.dog[level - kFinestDog], pixel,
                                             level_line, 2 * candidates.disparity[i], difference[i]);
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
