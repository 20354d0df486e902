// Exhaustive search for the shift between two small images.
#include "vo_core/image/image_shift.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/threads/parallel_loop.hpp"
#include "vo_core/geometry/parabola.hpp"

namespace cartvo::vo {
namespace {

constexpr int kMaximumShiftWidth = 120;  // px: the search takes half a millisecond
constexpr int kRefinement = 2;           // px of the level around the shift found in its half

struct Shift {
  int x = 0, y = 0;
};

/// A small image.
struct Thumbnail {
  int width = 0, height = 0;
  std::vector<std::uint8_t> grey;

  const std::uint8_t* at(int x, int y) const { return grey.data() + y * width + x; }
};

Thumbnail copyOf(const PyramidLevel& level) {
  Thumbnail copy{level.width(), level.height(), {}};
  copy.grey.reserve(static_cast<std::size_t>(copy.width) * copy.height);
  for (int y = 0; y < copy.height; ++y)
    copy.grey.insert(copy.grey.end(), level.at(0, y), level.at(0, y) + copy.width);
  return copy;
}

/// Means of blocks of 2x2 px.
Thumbnail halfOf(const Thumbnail& image) {
  Thumbnail half{image.width / 2, image.height / 2, {}};
  half.grey.reserve(static_cast<std::size_t>(half.width) * half.height);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      const std::uint8_t* upper = image.at(2 * x, 2 * y);
      const std::uint8_t* lower = upper + image.width;
      half.grey.push_back(static_cast<std::uint8_t>((upper[0] + upper[1] + lower[0] + lower[1] + 2) / 4));
    }
  }
  return half;
}

/// Sums over the overlap of two images.
struct OverlapSums {
  std::int64_t pixels = 0, before = 0, after = 0, before_square = 0, after_square = 0, product = 0;

  double correlation() const {
    const auto n = static_cast<double>(pixels);
    const auto covariance =
        static_cast<double>(product) - static_cast<double>(before) / n * static_cast<double>(after);
    const auto variance = [n](std::int64_t sum, std::int64_t square) {
      return static_cast<double>(square) - static_cast<double>(sum) / n * static_cast<double>(sum);
    };
    const double norm = variance(before, before_square) * variance(after, after_square);
    return norm > 0.0 ? covariance / std::sqrt(norm) : 0.0;
  }
};

void addRow(const std::uint8_t* before, const std::uint8_t* after, int count, OverlapSums& sums) {
  std::int32_t a = 0, b = 0, aa = 0, bb = 0, ab = 0;  // a row has at most kMaximumShiftWidth px
  for (int i = 0; i < count; ++i) {
    const std::int32_t x = before[i], y = after[i];
    a += x;
    b += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  sums.pixels += count;
  sums.before += a;
  sums.after += b;
  sums.before_square += aa;
  sums.after_square += bb;
  sums.product += ab;
}

double correlationAt(const Thumbnail& before, const Thumbnail& after, const Shift& shift) {
  const int left = std::max(0, -shift.x), top = std::max(0, -shift.y);
  const int right = std::min(before.width, after.width - shift.x);
  const int bottom = std::min(before.height, after.height - shift.y);
  OverlapSums sums;
  for (int y = top; y < bottom; ++y)
    addRow(before.at(left, y), after.at(left + shift.x, y + shift.y), right - left, sums);
  return sums.correlation();
}

/// Correlations at all shifts that differ from `centre` by at most `reach`.
class Correlations {
 public:
  Correlations(const Thumbnail& before, const Thumbnail& after, const Shift& centre, const Shift& reach)
      : first_{centre.x - reach.x, centre.y - reach.y},
        columns_(2 * reach.x + 1),
        rows_(2 * reach.y + 1),
        values_(static_cast<std::size_t>(columns_) * rows_) {
    forEachIndex(rows_, [&](std::size_t row) {
      for (int column = 0; column < columns_; ++column)
        values_[row * columns_ + column] =
            correlationAt(before, after, {first_.x + column, first_.y + static_cast<int>(row)});
    });
    best_ = static_cast<int>(std::max_element(values_.begin(), values_.end()) - values_.begin());
  }

  double highest() const { return values_[best_]; }
  Shift best() const { return {first_.x + column(), first_.y + row()}; }
  /// The best shift with fractions of a pixel.
  Eigen::Vector2d peak() const {
    Eigen::Vector2d peak(best().x, best().y);
    const double* const at = values_.data() + best_;
    if (column() > 0 && column() < columns_ - 1) peak.x() += vertexOfParabola(at[-1], *at, at[1]);
    if (row() > 0 && row() < rows_ - 1) peak.y() += vertexOfParabola(at[-columns_], *at, at[columns_]);
    return peak;
  }

 private:
  int column() const { return best_ % columns_; }
  int row() const { return best_ / columns_; }

  Shift first_;
  int columns_, rows_;
  std::vector<double> values_;
  int best_ = 0;
};

}  // namespace

std::optional<Eigen::Vector2d> findImageShift(const ImagePyramid& before, const ImagePyramid& after) {
  const std::size_t levels = std::min(before.grey.size(), after.grey.size());
  if (levels == 0) return std::nullopt;
  Thumbnail from = copyOf(before.grey[levels - 1]), to = copyOf(after.grey[levels - 1]);
  double scale = levelScale(static_cast<int>(levels) - 1);
  for (; from.width > kMaximumShiftWidth; scale *= 2.0) {
    from = halfOf(from);
    to = halfOf(to);
  }
  const Shift reach{from.width / 6, from.height / 6};
  const Shift coarse = Correlations(halfOf(from), halfOf(to), {}, reach).best();
  const Correlations fine(from, to, {2 * coarse.x, 2 * coarse.y}, {kRefinement, kRefinement});
  if (fine.highest() <= 0.0) return std::nullopt;
  return scale * fine.peak();
}

}  // namespace cartvo::vo
