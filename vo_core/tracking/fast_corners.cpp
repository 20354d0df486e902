// FAST-9 corners, scored by the sum of absolute differences, with 3x3 non-maximum suppression.
#include "vo_core/tracking/fast_corners.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

#include "vo_core/simd/vector_widths.hpp"
#include "vo_core/tracking/fast_block.hpp"

namespace cartvo::vo {
namespace {

/// Whether nine contiguous bits of the ring of sixteen are set.
bool hasArc(std::uint32_t bits) {
  const std::uint32_t ring = bits | bits << kCircle;
  std::uint32_t run = ring & ring >> 1;  // runs of 2, 4, 8
  run &= run >> 2;
  run &= run >> 4;
  return (run & ring >> 8) != 0;
}

/// Score of one pixel, as fastScore().
std::uint16_t scoreAt(const std::uint8_t* centre, const Circle& offsets, int threshold) {
  std::uint32_t bright_bits = 0;
  std::uint32_t dark_bits = 0;
  int bright_sum = 0;
  int dark_sum = 0;
  for (int i = 0; i < kCircle; ++i) {
    const int difference = centre[offsets[i]] - *centre;
    if (difference > threshold) {
      bright_bits |= 1u << i;
      bright_sum += difference;
    } else if (difference < -threshold) {
      dark_bits |= 1u << i;
      dark_sum -= difference;
    }
  }
  if (hasArc(bright_bits)) return static_cast<std::uint16_t>(bright_sum);
  if (hasArc(dark_bits)) return static_cast<std::uint16_t>(dark_sum);
  return 0;
}

/// Number of scores of a row: a block with corners is read whole, however narrow the image.
int scoredWidth(int columns) {
  constexpr int kWidestBlock = 64;
  return std::max(columns, kWidestBlock + 2 * kFastRadius);
}

std::size_t maximumBlocks(int width) {
  constexpr int kNarrowestBlock = 16;
  return static_cast<std::size_t>(width / kNarrowestBlock) + 1;
}

/// A row of an image; columns [kFastRadius, width - kFastRadius) are scored.
struct ImageRow {
  const std::uint8_t* pixels;
  std::ptrdiff_t step;  ///< bytes to the next row
  int width;
  const std::uint8_t* thresholds;
};

/// Writes the scores and the first columns of those blocks of kSize columns that contain corners; returns the
/// number of these blocks.
template <int kSize>
int scoreBlocks(const ImageRow& row, std::uint16_t* scores, int* blocks) {
  const Circle offsets = circle(row.step);
  const int last = row.width - kFastRadius - kSize;
  if (last < kFastRadius) {
    for (int x = kFastRadius; x < row.width - kFastRadius; ++x)
      scores[x] = scoreAt(row.pixels + x, offsets, row.thresholds[x]);
    blocks[0] = kFastRadius;
    return 1;
  }
  int count = 0;
  for (int next = kFastRadius; next < last + kSize; next += kSize) {
    const int x = std::min(next, last);  // the last block overlaps the one before
    PixelBlock<kSize> block(row.pixels + x, row.thresholds + x, offsets);
    if (block.findCorners()) {
      block.score(scores + x);
      blocks[count++] = x;
    } else {
      std::memset(scores + x, 0, kSize * sizeof *scores);
    }
  }
  return count;
}

/// Bit mask of the scores of a block that are the greatest in their 3x3 neighbourhood.
template <int kSize>
std::uint64_t maximaOf(const std::uint16_t* above, const std::uint16_t* row, const std::uint16_t* below) {
  using Shorts = typename ByteVectors<kSize>::Shorts;
  using HalfBytes = typename ByteVectors<kSize / 2>::Bytes;
  HalfBytes are_maxima[2];
  for (int half = 0; half < 2; ++half) {
    const int at = half * kSize / 2;
    Shorts score, before, after, other;
    std::memcpy(&score, row + at, sizeof score);
    std::memcpy(&before, row + at - 1, sizeof before);
    std::memcpy(&after, row + at + 1, sizeof after);
#pragma GCC unroll 3
    for (int side = -1; side <= 1; ++side) {
      std::memcpy(&other, above + at + side, sizeof other);
      before = before < other ? other : before;
      std::memcpy(&other, below + at + side, sizeof other);
      after = after < other ? other : after;
    }
    // "No less than those after" is "more than one less than those after".
    const Shorts one_less = (after < 1 ? Shorts{} + 1 : after) - 1;
    const Shorts is_maximum = score > (before < one_less ? one_less : before);
    are_maxima[half] = __builtin_convertvector(is_maximum, HalfBytes);
  }
  typename ByteVectors<kSize>::Bytes both;
  std::memcpy(&both, are_maxima, sizeof both);
  return bitsOf<kSize>(both);
}

/// Writes the columns of a row's local maxima, which lie in its blocks with corners; returns their number.
template <int kSize>
int maximaOfBlocks(const std::uint16_t* above, const std::uint16_t* row, const std::uint16_t* below,
                   const int* blocks, int block_count, int* columns) {
  int count = 0;
  int next = 0;
  for (int i = 0; i < block_count; ++i) {
    const int x = blocks[i];
    const int known = std::max(next - x, 0);  // columns of the last block that are part of the one before
    for (std::uint64_t left = maximaOf<kSize>(above + x, row + x, below + x) >> known << known; left != 0;
         left &= left - 1)
      columns[count++] = x + std::countr_zero(left);
    next = x + kSize;
  }
  return count;
}

CARTVO_BY_VECTOR_WIDTH(int scoreRow(const ImageRow& row, std::uint16_t* scores, int* blocks),
                       return scoreBlocks<kSize>(row, scores, blocks);)
CARTVO_BY_VECTOR_WIDTH(int findMaxima(const std::uint16_t* above, const std::uint16_t* row,
                                      const std::uint16_t* below, const int* blocks, int block_count,
                                      int* columns),
                       return maximaOfBlocks<kSize>(above, row, below, blocks, block_count, columns);)

}  // namespace

std::uint16_t fastScore(const cv::Mat& image, int x, int y, int threshold) {
  return scoreAt(image.ptr(y) + x, circle(static_cast<std::ptrdiff_t>(image.step)), threshold);
}

WindowThresholds::WindowThresholds(const cv::Size& image_size, int window_rows)
    : thresholds_(static_cast<std::size_t>(window_rows) * image_size.width, kNoCorners) {
  for (int y = 0; y < image_size.height; ++y)
    begin_.push_back(((y + 1) * window_rows - 1) / image_size.height * image_size.width);
}

void WindowThresholds::set(const cv::Rect& window, std::uint8_t threshold) {
  std::fill_n(&thresholds_[begin_[window.y]] + window.x, window.width, threshold);
}

void CornerFinder::reserve(int columns, int rows) {
  const auto width = static_cast<std::size_t>(scoredWidth(columns));
  maxima_.reserve(maximumCorners(columns, rows));
  columns_.reserve(width);
  for (ScoredRow& row : rows_) {
    row.scores.reserve(width);
    row.blocks.reserve(maximumBlocks(scoredWidth(columns)));
  }
}

void CornerFinder::score(const cv::Mat& image, int y, const WindowThresholds& thresholds) {
  ScoredRow& row = at(y);
  const int width = scoredWidth(image.cols);
  const bool empty = y < kFastRadius || y >= image.rows - kFastRadius;
  if (empty || width > image.cols || static_cast<int>(row.scores.size()) != width)
    row.scores.assign(width, 0);
  row.blocks.resize(maximumBlocks(width));
  row.block_count = 0;
  if (empty) return;
  const ImageRow pixels{image.ptr(y), static_cast<std::ptrdiff_t>(image.step), image.cols, thresholds.row(y)};
  row.block_count = scoreRow(pixels, row.scores.data(), row.blocks.data());
}

void CornerFinder::suppress(int y) {
  const ScoredRow& row = at(y);
  columns_.resize(row.scores.size());
  const int count = findMaxima(at(y - 1).scores.data(), row.scores.data(), at(y + 1).scores.data(),
                               row.blocks.data(), row.block_count, columns_.data());
  for (int i = 0; i < count; ++i)
    maxima_.push_back({columns_[i], y, row.scores[columns_[i]]});
}

const std::vector<Corner>& CornerFinder::find(const cv::Mat& image, const cv::Range& rows,
                                              const WindowThresholds& thresholds) {
  maxima_.clear();
  maxima_.reserve(maximumCorners(image.cols, rows.size()));
  score(image, rows.start - 1, thresholds);
  score(image, rows.start, thresholds);
  for (int y = rows.start; y < rows.end; ++y) {
    score(image, y + 1, thresholds);
    suppress(y);
  }
  return maxima_;
}

}  // namespace cartvo::vo
