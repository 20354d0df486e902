// From the left image to the right one, for one feature.
#include "vo_core/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "vo_core/ncc_search.hpp"

namespace cartvo {
namespace {

constexpr int kCandidates = 3;    // of the coarsest level
constexpr int kSearchRadius = 3;  // px at each finer level
constexpr int kSadColumns = 16, kSadRows = 9;
constexpr int kDistinct = 3;            // px; candidates closer than this are the same peak
constexpr double kLeastColumns = 0.05;  // px per px of disparity
constexpr double kNoRival = 1.3;        // times the least difference: a candidate that is none
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

  /// Sums of absolute differences to Count windows side by side, from that around `pixel` to the left.
  template <int Count>
  void compare(const PyramidLevel& right, const LevelPixel& pixel, int* sums) const {
    const std::uint8_t* from = right.at(pixel.x - kSadColumns / 2, pixel.y - kSadRows / 2);
#ifdef __SSE2__
    __m128i sum[Count] = {};
#pragma GCC unroll 9
    for (int row = 0; row < kSadRows; ++row, from += right.stride())
#pragma GCC unroll 8
      for (int i = 0; i < Count; ++i)
        sum[i] = _mm_add_epi32(
            sum[i], _mm_sad_epu8(rows_[row], _mm_loadu_si128(reinterpret_cast<const Row*>(from - i))));
    for (int i = 0; i < Count; ++i)
      sums[i] = _mm_cvtsi128_si32(sum[i]) + _mm_extract_epi16(sum[i], 4);
#else
    std::fill_n(sums, Count, 0);
    for (int row = 0; row < kSadRows; ++row, from += right.stride())
      for (int i = 0; i < Count; ++i)
        for (int column = 0; column < kSadColumns; ++column)
          sums[i] += std::abs(rows_[row][column] - from[column - i]);
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

constexpr int kFar = 1 << 30;  // a difference where the right image shows nothing
constexpr int kRun = 2 * kSearchRadius + 1;
using Differences = std::array<int, kRun>;

/// At kRun disparities from `first` on.
void compareAlong(const SadWindow& left, const PyramidLevel& right, const LevelLine& line, int first,
                  Differences& differences) {
  const LevelPixel from = line.at(first);
  const LevelPixel to = line.at(first + kRun - 1);
  // As steps are rounded, they are all one pixel if they are so together: nearly always.
  if (from.y == to.y && from.x - to.x == kRun - 1 && contains(right, from) && contains(right, to))
    return left.compare<kRun>(right, from, differences.data());
  for (int i = 0; i < kRun; ++i) {
    const LevelPixel at = line.at(first + i);
    differences[i] = kFar;
    if (contains(right, at)) left.compare<1>(right, at, &differences[i]);
  }
}

/// The deepest local minima of the sum of absolute differences over the whole range of disparity.
Candidates searchCoarsest(const SadWindow& left, const PyramidLevel& right, const LevelLine& line,
                          int maximum_disparity) {
  std::array<int, kCandidates> best_sad;
  best_sad.fill(kFar);
  Candidates candidates;
  Differences differences;
  const auto difference = [&](int disparity) {
    if (disparity % kRun == 0) compareAlong(left, right, line, disparity, differences);
    return disparity <= maximum_disparity ? differences[disparity % kRun] : kFar;
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
  Differences differences;
  compareAlong(left, right, line, disparity - kSearchRadius, differences);
  const auto least = std::min_element(differences.begin(), differences.end());
  best_sad = *least;
  return best_sad == kFar ? disparity
                          : disparity - kSearchRadius + static_cast<int>(least - differences.begin());
}

/// The best correlation around an integer disparity and its sub-pixel place. Left and right are sampled at
/// the same fractions of a pixel: the same blur in both, so that interpolation biases nothing.
StereoMatch correlateAround(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& pixel,
                            const EpipolarLine& line, int disparity, int rows) {
  StereoMatch best;
  const Eigen::Vector2d centre = line.at(pixel, disparity);
  if (!right.contains(centre)) return best;
  const NccPeak peak = highestPeak(left, right, centre, rows);
  if (peak.height <= 0.0) return best;
  // Near the epipole a column is many disparities.
  const double per_column = 1.0 / std::max(1.0 - line.per_disparity.x(), kLeastColumns);
  best.correlation = peak.height;
  best.row_offset = peak.row;
  best.disparity = disparity - peak.column() * per_column;  // to the right is less disparity
  best.right = line.at(pixel, best.disparity) + Eigen::Vector2d(0.0, peak.row);
  return best;
}

/// The levels of both pyramids from the finest that is looked at on.
struct PyramidPair {
  const PyramidLevel& left;
  const PyramidLevel& right;
  std::span<const PyramidLevel> left_dog, right_dog;  // of the levels from kFinestDog above that one on
};

/// The few best disparities in the finest difference of Gaussians, coarse to fine, and their differences.
Candidates searchDown(const PyramidPair& images, const Eigen::Vector2d& left, const EpipolarLine& line,
                      int maximum_disparity, std::array<int, kCandidates>& difference) {
  const int coarsest = kFinestDog + static_cast<int>(images.left_dog.size()) - 1;
  const PyramidLevel& coarse = images.left_dog.back();
  const LevelPixel coarse_pixel = pixelAt(coarse, left, coarsest);
  Candidates candidates =
      searchCoarsest(SadWindow(coarse, coarse_pixel), images.right_dog.back(),
                     LevelLine(coarse_pixel, line, coarsest), (maximum_disparity >> coarsest) + 1);
  for (int level = coarsest - 1; level >= kFinestDog; --level) {
    const PyramidLevel& left_level = images.left_dog[level - kFinestDog];
    const LevelPixel pixel = pixelAt(left_level, left, level);
    const SadWindow window(left_level, pixel);
    const LevelLine level_line(pixel, line, level);
    for (int i = 0; i < candidates.count; ++i)
      candidates.disparity[i] = searchAround(window, images.right_dog[level - kFinestDog], level_line,
                                             2 * candidates.disparity[i], difference[i]);
  }
  return candidates;
}

/// In px of the finest level, whatever the range of disparity; if it is the only one.
CARTVO_VECTOR_CLONES
std::optional<StereoMatch> onlyMatch(const PyramidPair& images, const Eigen::Vector2d& left,
                                     const EpipolarLine& line, int maximum_disparity,
                                     const StereoSettings& settings) {
  std::array<int, kCandidates> difference{};
  const Candidates candidates = searchDown(images, left, line, maximum_disparity, difference);
  if (candidates.count == 0) return std::nullopt;
  const int least = *std::min_element(difference.begin(), difference.begin() + candidates.count);

  NccTemplate patch;
  makeTemplate(images.left, left, patch);
  if (patch.norm < 1.0) return std::nullopt;
  StereoMatch best;
  double rival = 0.0;  // correlation of the best candidate elsewhere
  for (int i = 0; i < candidates.count; ++i) {
    if (difference[i] > kNoRival * least) continue;
    const StereoMatch match = correlateAround(patch, images.right, left, line,
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
  if (1.0 - best.correlation > settings.uniqueness * (1.0 - rival) - kNoiseFloor) return std::nullopt;
  return best;
}

}  // namespace

std::optional<StereoMatch> matchStereo(const ImagePyramid& left_image, const ImagePyramid& right_image,
                                       const Eigen::Vector2d& left, const StereoSettings& settings,
                                       const EpipolarLine& line, int level) {
  if (!bothHave(left_image, right_image, level) || left_image.dog.size() <= static_cast<std::size_t>(level))
    return std::nullopt;
  const PyramidPair images{left_image.grey[level], right_image.grey[level],
                           std::span(left_image.dog).subspan(level),
                           std::span(right_image.dog).subspan(level)};
  const double scale = levelScale(level);
  if (!images.left.contains(left / scale)) return std::nullopt;
  const EpipolarLine level_line{line.at_infinity / scale, line.per_disparity};
  auto match = onlyMatch(images, left / scale, level_line, settings.maximum_disparity >> level, settings);
  if (!match) return std::nullopt;
  match->disparity *= scale;
  match->right *= scale;
  if (match->disparity < settings.minimum_disparity || match->disparity > settings.maximum_disparity)
    return std::nullopt;
  return match;
}

}  // namespace cartvo
