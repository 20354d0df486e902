// Search for patches over both signs of the displacement.
#include "vo_core/image/patch_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "vo_core/geometry/parabola.hpp"

namespace cartvo::vo {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;

// Width of the coarse level, px: the coarsest that still shows the texture of a street, at most this.
constexpr int kCoarseWidth = 256;
constexpr int kCoarseRadius = 4, kCoarseSize = 2 * kCoarseRadius + 1;  // px, of the patch at that level
constexpr int kCoarsePixels = kCoarseSize * kCoarseSize;
constexpr int kPositions = 4;                                    // that are multiplied together
constexpr float kLeastVariance = kCoarsePixels * kCoarsePixels;  // of a texture: one grey value^2, times this
constexpr int kRowShare = 24;    // width over the largest displacement up and down
constexpr int kFineRadius = 5;   // px, of the patch at the levels of the refinement
constexpr int kFineReach = 2;    // px, by which a coarser level may be wrong
constexpr int kFinestLevel = 1;  // unless the coarse level is 1: finer texture is mostly noise
constexpr double kMinimumCoarseCorrelation = 0.7;  // lower than at the finest level: patches deform more
constexpr double kUniqueness = 0.8;
constexpr int kPeakRadius = 2;                         // px around a peak that belong to it
constexpr int kGridColumns = 14, kGridRows = 8;        // about a hundred patches
constexpr int kTextureRadius = 3, kTextureStride = 4;  // px

/// Mean squared gradient in the direction with the least texture.
double textureAt(const PyramidLevel& level, int x, int y) {
  std::int32_t xx = 0;
  std::int32_t xy = 0;
  std::int32_t yy = 0;
  for (int row = y - kTextureRadius; row <= y + kTextureRadius; ++row) {
    for (int column = x - kTextureRadius; column <= x + kTextureRadius; ++column) {
      const int dx = *level.at(column + 1, row) - *level.at(column - 1, row);
      const int dy = *level.at(column, row + 1) - *level.at(column, row - 1);
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  }
  constexpr double kPixels = (2.0 * kTextureRadius + 1.0) * (2.0 * kTextureRadius + 1.0);
  const double half_difference = 0.5 * (xx - yy);
  const double smaller =
      0.5 * (xx + yy) - std::sqrt(half_difference * half_difference + static_cast<double>(xy) * xy);
  return smaller / (4.0 * kPixels);  // central differences span two pixels
}

/// Correlation of two patches; 0 if one of them has no texture.
double correlationOf(const PyramidLevel& a, const Vector2i& at_a, const PyramidLevel& b,
                     const Vector2i& at_b) {
  std::int32_t sum_a = 0, sum_b = 0, aa = 0, ab = 0, bb = 0;
  for (int y = -kFineRadius; y <= kFineRadius; ++y) {
    const std::uint8_t* const row_a = a.at(at_a.x() - kFineRadius, at_a.y() + y);
    const std::uint8_t* const row_b = b.at(at_b.x() - kFineRadius, at_b.y() + y);
    for (int x = 0; x <= 2 * kFineRadius; ++x) {
      sum_a += row_a[x];
      sum_b += row_b[x];
      aa += row_a[x] * row_a[x];
      ab += row_a[x] * row_b[x];
      bb += row_b[x] * row_b[x];
    }
  }
  constexpr double kPixels = (2.0 * kFineRadius + 1.0) * (2.0 * kFineRadius + 1.0);
  const double covariance = ab - static_cast<double>(sum_a) * sum_b / kPixels;
  const double product = (aa - static_cast<double>(sum_a) * sum_a / kPixels) *
                         (bb - static_cast<double>(sum_b) * sum_b / kPixels);
  return product > 0.0 ? covariance / std::sqrt(product) : 0.0;
}

bool patchFits(const PyramidLevel& level, const Vector2i& centre, int radius) {
  return centre.x() >= radius && centre.y() >= radius && centre.x() + radius < level.width() &&
         centre.y() + radius < level.height();
}

/// The highest correlation within kFineReach of a displacement at one level.
struct FinePeak {
  Vector2i displacement = Vector2i::Zero();
  Vector2d subpixel = Vector2d::Zero();  ///< to be added
  double correlation = 0.0;
};

std::optional<FinePeak> finePeak(const PyramidLevel& from, const Vector2i& centre, const PyramidLevel& to,
                                 const Vector2i& guess) {
  constexpr int kSide = 2 * kFineReach + 1;
  std::array<std::array<double, kSide>, kSide> values;
  int best_x = 0;
  int best_y = 0;
  if (!patchFits(from, centre, kFineRadius) || !patchFits(to, centre + guess, kFineRadius + kFineReach))
    return std::nullopt;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Vector2i shift(x - kFineReach, y - kFineReach);
      values[y][x] = correlationOf(from, centre, to, centre + guess + shift);
      if (values[y][x] > values[best_y][best_x]) best_x = x, best_y = y;
    }
  }
  // At the border the peak lies farther away.
  if (best_x == 0 || best_y == 0 || best_x == kSide - 1 || best_y == kSide - 1) return std::nullopt;
  FinePeak peak;
  peak.displacement = guess + Vector2i(best_x - kFineReach, best_y - kFineReach);
  peak.correlation = values[best_y][best_x];
  peak.subpixel = {
      vertexOfParabola(values[best_y][best_x - 1], peak.correlation, values[best_y][best_x + 1]),
      vertexOfParabola(values[best_y - 1][best_x], peak.correlation, values[best_y + 1][best_x])};
  return peak;
}

}  // namespace

PatchSearch::PatchSearch(int width, const PatchDemands& demands, int most_levels) : demands_(demands) {
  while ((width >> coarse_level_) > kCoarseWidth && levels() < most_levels)
    ++coarse_level_;
  centres_.reserve(kGridColumns * kGridRows);
}

const std::vector<Vector2i>& PatchSearch::choosePatches(const ImagePyramid& image) {
  centres_.clear();
  if (static_cast<int>(image.grey.size()) < levels()) return centres_;
  const PyramidLevel& level = image.grey[coarse_level_];
  constexpr int kMargin = kCoarseRadius + kPeakRadius;
  const int width = level.width() - 2 * kMargin;
  const int height = level.height() - 2 * kMargin;
  for (int cell = 0; cell < kGridColumns * kGridRows; ++cell) {
    const int column = cell % kGridColumns;
    const int row = cell / kGridColumns;
    double best = demands_.texture;
    std::optional<Vector2i> chosen;
    for (int y = kMargin + row * height / kGridRows; y < kMargin + (row + 1) * height / kGridRows;
         y += kTextureStride) {
      for (int x = kMargin + column * width / kGridColumns; x < kMargin + (column + 1) * width / kGridColumns;
           x += kTextureStride) {
        const double texture = textureAt(level, x, y);
        if (texture > best) best = texture, chosen = Vector2i(x, y);
      }
    }
    if (chosen) centres_.push_back(*chosen);
  }
  return centres_;
}

void PatchSearch::setSearched(const ImagePyramid& image, int column_share) {
  column_share_ = column_share;
  searched_ = &image;
  if (static_cast<int>(image.grey.size()) < levels()) return;
  const PyramidLevel& level = image.grey[coarse_level_];
  const std::size_t stride = static_cast<std::size_t>(level.width()) + 1;
  sums_.assign(stride * (level.height() + 1), 0);
  squares_.assign(sums_.size(), 0);
  pairs_.assign(2 * (static_cast<std::size_t>(level.width()) * level.height() + kCoarseSize + kPositions), 0);
  std::int16_t* pair = pairs_.data();
  for (int y = 0; y < level.height(); ++y) {
    std::uint32_t sum = 0;
    std::uint32_t square = 0;
    for (int x = 0; x < level.width(); ++x) {
      const std::uint32_t value = *level.at(x, y);
      sum += value;
      square += value * value;
      const std::size_t index = (y + 1) * stride + x + 1;
      sums_[index] = sums_[index - stride] + sum;
      squares_[index] = squares_[index - stride] + square;
      *pair++ = *level.at(x, y);
      *pair++ = *level.at(x + 1, y);
    }
  }
}

/// Products of the patch with the windows at four positions in a row, `pairs` being the first one's corner.
void PatchSearch::multiplyFour(const std::int16_t* pairs, std::size_t stride, std::int32_t* products) const {
#ifdef __SSE2__
  __m128i sum = _mm_setzero_si128();
  const std::int32_t* weight = weights_.data();
  for (int y = 0; y < kCoarseSize; ++y, pairs += 2 * stride)
    for (int x = 0; x < kCoarseSize; x += 2)
      sum =
          _mm_add_epi32(sum, _mm_madd_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(pairs + 2 * x)),
                                            _mm_set1_epi32(*weight++)));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(products), sum);
#else
  std::fill_n(products, kPositions, 0);
  const std::int32_t* weight = weights_.data();
  for (int y = 0; y < kCoarseSize; ++y, pairs += 2 * stride) {
    for (int x = 0; x < kCoarseSize; x += 2, ++weight) {
      const std::int32_t low = *weight & 0xffff;
      const std::int32_t high = *weight >> 16;
      for (int i = 0; i < kPositions; ++i)
        products[i] += low * pairs[2 * (x + i)] + high * pairs[2 * (x + i) + 1];
    }
  }
#endif
}

/// Loads the patch of findCoarse(). Returns the variance of its pixels times the square of their number.
float PatchSearch::loadPatch(const PyramidLevel& from, const Vector2i& centre) {
  weights_.clear();
  patch_sum_ = 0;
  std::int32_t squares = 0;
  for (int y = -kCoarseRadius; y <= kCoarseRadius; ++y) {
    for (int x = -kCoarseRadius; x <= kCoarseRadius; x += 2) {
      const std::int32_t low = *from.at(centre.x() + x, centre.y() + y);
      const std::int32_t high = x < kCoarseRadius ? *from.at(centre.x() + x + 1, centre.y() + y) : 0;
      weights_.push_back(low | high << 16);
      patch_sum_ += low + high;
      squares += low * low + high * high;
    }
  }
  return static_cast<float>(kCoarsePixels * squares - patch_sum_ * patch_sum_);
}

/// Scores of `count` positions in a row from `first` (centres in the searched image) on.
void PatchSearch::correlateRow(const Vector2i& first, int count, float* scores) {
  const std::size_t width = searched_->grey[coarse_level_].width();
  const std::int16_t* const pairs =
      pairs_.data() + 2 * ((first.y() - kCoarseRadius) * width + first.x() - kCoarseRadius);
  products_.resize(count + kPositions);
  for (int i = 0; i < count; i += kPositions)
    multiplyFour(pairs + static_cast<std::ptrdiff_t>(2) * i, width, products_.data() + i);
  const std::size_t top = (first.y() - kCoarseRadius) * (width + 1) + first.x() - kCoarseRadius;
  const std::size_t bottom = top + kCoarseSize * (width + 1);
  const auto over = [&](const std::vector<std::uint32_t>& sums, int i) {
    return static_cast<std::int32_t>(sums[bottom + i + kCoarseSize] - sums[bottom + i] -
                                     sums[top + i + kCoarseSize] + sums[top + i]);
  };
  static_assert(kCoarsePixels * kCoarsePixels * 255 * 255 < 2147483648.0, "the products fit into 32 bits");
  for (int i = 0; i < count; ++i) {
    const std::int32_t sum = over(sums_, i);
    const auto variance = static_cast<float>(kCoarsePixels * over(squares_, i) - sum * sum);
    const auto covariance = static_cast<float>(kCoarsePixels * products_[i] - patch_sum_ * sum);
    scores[i] = covariance > 0.0F && variance > kLeastVariance ? covariance * covariance / variance : 0.0F;
  }
}

/// Index of the highest of the scores, if it is high enough and unique. `norm`: of a perfect correlation.
std::optional<Vector2i> PatchSearch::uniquePeak(int columns, int rows, float norm) const {
  const auto best = std::max_element(scores_.begin(), scores_.begin() + static_cast<long>(columns) * rows);
  const auto index = static_cast<int>(best - scores_.begin());
  const Vector2i peak(index % columns, index / columns);
  const float correlation = std::sqrt(*best / norm);
  if (correlation < kMinimumCoarseCorrelation) return std::nullopt;
  float second = 0.0F;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (std::abs(y - peak.y()) <= kPeakRadius && std::abs(x - peak.x()) <= kPeakRadius) continue;
      second = std::max(second, scores_[static_cast<std::size_t>(y) * columns + x]);
    }
  }
  if (1.0F - correlation > kUniqueness * (1.0F - std::sqrt(second / norm))) return std::nullopt;
  return peak;
}

std::optional<Vector2i> PatchSearch::findCoarse(const PyramidLevel& from, const Vector2i& centre) {
  const PyramidLevel& to = searched_->grey[coarse_level_];
  const int reach_x = to.width() / column_share_;
  const int reach_y = to.width() / kRowShare;
  const Vector2i first(std::max(kCoarseRadius, centre.x() - reach_x),
                       std::max(kCoarseRadius, centre.y() - reach_y));
  const Vector2i last(std::min(to.width() - 1 - kCoarseRadius, centre.x() + reach_x),
                      std::min(to.height() - 1 - kCoarseRadius, centre.y() + reach_y));
  const float variance = loadPatch(from, centre);
  if (!(variance > kLeastVariance)) return std::nullopt;
  const Vector2i size = last - first + Vector2i::Ones();
  scores_.resize(static_cast<std::size_t>(size.x()) * size.y());
  for (int y = 0; y < size.y(); ++y)
    correlateRow(first + Vector2i(0, y), size.x(), scores_.data() + static_cast<std::size_t>(y) * size.x());
  const auto peak = uniquePeak(size.x(), size.y(), variance);
  if (!peak) return std::nullopt;
  return first + *peak - centre;
}

std::optional<Vector2d> PatchSearch::find(const ImagePyramid& image, const Vector2i& centre) {
  if (!bothHave(image, *searched_, coarse_level_)) return std::nullopt;
  const auto coarse = findCoarse(image.grey[coarse_level_], centre);
  if (!coarse) return std::nullopt;
  FinePeak peak;
  peak.displacement = *coarse;
  const int finest = coarse_level_ > kFinestLevel ? kFinestLevel : 0;
  int level = coarse_level_;
  do {
    if (level > finest) {
      --level;
      peak.displacement *= 2;
    }
    const Vector2i place = centre * (1 << (coarse_level_ - level));
    const auto finer = finePeak(image.grey[level], place, searched_->grey[level], peak.displacement);
    if (!finer) return std::nullopt;
    peak = *finer;
  } while (level > finest);
  if (peak.correlation < demands_.correlation) return std::nullopt;
  return levelScale(level) * (peak.displacement.cast<double>() + peak.subpixel);
}

}  // namespace cartvo::vo
