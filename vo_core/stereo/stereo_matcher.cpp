// Stereo matching of one feature: coarse-to-fine search by SAD along the epipolar line, then NCC with a
// sub-pixel fit.
#include "vo_core/stereo/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>

#include "vo_core/stereo/ncc_search.hpp"
#include "vo_core/stereo/sad_window.hpp"

namespace cartvo::vo {
namespace {

constexpr int kCandidates = 3;           // candidates that are kept from the coarsest level
constexpr int kSearchRadius = 3;         // px at each finer level
constexpr int kMinimumPeakDistance = 3;  // px of disparity; candidates closer than this are the same peak
constexpr double kNoiseFloor = 0.002;    // of 1 - correlation: smaller differences are noise
constexpr double kMinimumColumnsPerDisparity = 0.05;  // px per px of disparity

bool contains(const PyramidLevel& level, const LevelPixel& pixel) {
  return pixel.x >= 0 && pixel.y >= 0 && pixel.x < level.width() && pixel.y < level.height();
}

struct Candidates {
  std::array<int, kCandidates> disparity{};
  int count = 0;
};

/// Rounds to the nearest integer; for values above -kRoundingBias, as all pixel coordinates are.
int rounded(double value) {
  constexpr int kRoundingBias = 1 << 20;
  return static_cast<int>(value + (kRoundingBias + 0.5)) - kRoundingBias;
}

LevelPixel pixelAt(const PyramidLevel& level, const Eigen::Vector2d& pixel, int index) {
  const double scale = 1.0 / (1 << index);
  return {std::min(rounded(pixel.x() * scale), level.width() - 1),
          std::min(rounded(pixel.y() * scale), level.height() - 1)};
}

/// Epipolar line of one left pixel in one pyramid level.
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

constexpr int kSadOutsideImage = 1 << 24;  // SAD where the right image has no pixels
static_assert(kSadRun == 2 * kSearchRadius + 1);

/// SADs at kSadRun disparities from `first` on.
void compareAlong(const SadWindow& left, const PyramidLevel& right, const LevelLine& line, int first,
                  SadRun& differences) {
  const LevelPixel from = line.at(first);
  const LevelPixel to = line.at(first + kSadRun - 1);
  // The steps are rounded: if all together are one pixel each, every single one is. This is nearly always so.
  if (from.y == to.y && from.x - to.x == kSadRun - 1 && contains(right, from) && contains(right, to))
    return left.compareRun(right, from, differences);
  for (int i = 0; i < kSadRun; ++i) {
    const LevelPixel at = line.at(first + i);
    differences[i] = kSadOutsideImage;
    if (contains(right, at)) differences[i] = left.compareOne(right, at);
  }
}

/// The lowest local minima of the SAD over the whole range of disparity.
Candidates searchCoarsest(const SadWindow& left, const PyramidLevel& right, const LevelLine& line,
                          int maximum_disparity) {
  std::array<int, kCandidates> best_sad;
  best_sad.fill(kSadOutsideImage);
  Candidates candidates;
  SadRun differences;
  const auto difference = [&](int disparity) {
    if (disparity % kSadRun == 0) compareAlong(left, right, line, disparity, differences);
    return disparity <= maximum_disparity ? differences[disparity % kSadRun] : kSadOutsideImage;
  };
  int previous = kSadOutsideImage;
  int current = difference(0);
  for (int disparity = 0; disparity <= maximum_disparity; ++disparity) {
    const int next = difference(disparity + 1);
    // Without a branch on each comparison: their outcomes are unpredictable.
    const bool deep = (current <= previous) & (current < next) & (current < best_sad[kCandidates - 1]);
    if (deep) {
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

/// The disparity of the least SAD around a given one, and that SAD.
int searchAround(const SadWindow& left, const PyramidLevel& right, const LevelLine& line, int disparity,
                 int& best_sad) {
  SadRun differences;
  compareAlong(left, right, line, disparity - kSearchRadius, differences);
  // The first minimum, without a branch on each comparison.
  constexpr int kPlaces = 8;
  static_assert(kSadRun <= kPlaces);
  int least = kPlaces * kSadOutsideImage;
  for (int i = 0; i < kSadRun; ++i)
    least = std::min(least, kPlaces * differences[i] + i);
  best_sad = least / kPlaces;
  return best_sad == kSadOutsideImage ? disparity : disparity - kSearchRadius + least % kPlaces;
}

/// The best correlation around an integer disparity and its sub-pixel position. Left and right are sampled at
/// the same fractions of a pixel: the same blur in both, so that interpolation causes no bias.
StereoMatch correlateAround(const NccTemplate& left, const PyramidLevel& right, const Eigen::Vector2d& pixel,
                            const EpipolarLine& line, int disparity, int rows) {
  StereoMatch best;
  const Eigen::Vector2d centre = line.at(pixel, disparity);
  if (!right.contains(centre)) return best;
  const NccPeak peak = highestPeak(left, right, centre, rows);
  if (peak.height <= 0.0) return best;
  // Near the epipole a column is many disparities.
  const double per_column = 1.0 / std::max(1.0 - line.per_disparity.x(), kMinimumColumnsPerDisparity);
  best.correlation = peak.height;
  best.disparity = disparity - peak.column() * per_column;  // disparity decreases to the right
  best.right = line.at(pixel, best.disparity) + Eigen::Vector2d(0.0, peak.row);
  return best;
}

/// Both pyramids, from the finest level in use on.
struct PyramidPair {
  const PyramidLevel& left;
  const PyramidLevel& right;
  std::span<const PyramidLevel> left_dog,
      right_dog;  // DoG levels, kFinestDog above that one and coarser
};

/// The best disparities in the finest difference of Gaussians, searched coarse to fine, and their SADs.
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

/// Arguments of a search, in px of the finest level.
struct MatchRequest {
  const PyramidPair& images;
  const Eigen::Vector2d& left;
  const EpipolarLine& line;
  int maximum_disparity;
  const StereoSettings& settings;
};

/// The match in px of the finest level, whatever its disparity; nothing if it is ambiguous.
std::optional<StereoMatch> findUniqueMatch(const MatchRequest& request) {
  const auto& [images, left, line, maximum_disparity, settings] = request;
  std::array<int, kCandidates> difference{};
  const Candidates candidates = searchDown(images, left, line, maximum_disparity, difference);
  if (candidates.count == 0) return std::nullopt;
  const int least = *std::min_element(difference.begin(), difference.begin() + candidates.count);

  NccTemplate patch;
  makeTemplate(images.left, left, patch);
  if (patch.norm < 0.5 * kGreyUnits) return std::nullopt;
  StereoMatch best;
  double second_best = 0.0;  // correlation of the best candidate at another disparity
  for (int i = 0; i < candidates.count; ++i) {
    if (difference[i] > settings.maximum_sad_ratio * least) continue;
    const StereoMatch match = correlateAround(patch, images.right, left, line,
                                              candidates.disparity[i] << kFinestDog, settings.rows);
    if (match.correlation <= 0.0) continue;
    const bool elsewhere = std::abs(match.disparity - best.disparity) > kMinimumPeakDistance;
    if (match.correlation > best.correlation) {
      if (elsewhere) second_best = best.correlation;
      best = match;
    } else if (elsewhere) {
      second_best = std::max(second_best, match.correlation);
    }
  }
  if (best.correlation < settings.minimum_correlation) return std::nullopt;
  if (1.0 - best.correlation > settings.uniqueness * (1.0 - second_best) - kNoiseFloor) return std::nullopt;
  return best;
}

CARTVO_TARGET_CLONES std::optional<StereoMatch> dispatchMatch(const MatchRequest& request) {
  return findUniqueMatch(request);
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
  const Eigen::Vector2d level_left = left / scale;
  auto found = dispatchMatch({images, level_left, level_line, settings.maximum_disparity >> level, settings});
  if (!found) return std::nullopt;
  found->disparity *= scale;
  found->right *= scale;
  if (found->disparity < settings.minimum_disparity || found->disparity > settings.maximum_disparity)
    return std::nullopt;
  return found;
}

}  // namespace cartvo::vo
