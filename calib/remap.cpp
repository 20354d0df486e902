#include "calib/remap.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "vo_core/quads.hpp"

namespace cartvo {
namespace {

/// The places of sixteen pixels, and how many of them are wanted.
struct Places {
  const std::uint16_t *column, *row;
  const std::uint8_t *column_fraction, *row_fraction;
};

/// Of each place the raw pixel, those right of it, below it and below to the right, lowest byte first.
void fetchApart(const cv::Mat& source, const Places& places, IntLanes& quads) {
  ShortLanes row, column;
  std::memcpy(&row, places.row, sizeof row);
  std::memcpy(&column, places.column, sizeof column);
  const auto stride = static_cast<int>(source.step[0]);
  const IntLanes offset =
      __builtin_convertvector(row, IntLanes) * stride + __builtin_convertvector(column, IntLanes);
  fetchQuadsOneByOne(source.data, stride, offset, kLanes, quads);
}

/// The same out of four rows of 32 pixels; false if those do not hold them all, or the image not those.
template <typename Processor>
bool fetchTogether(const cv::Mat& source, const Places& places, IntLanes& quads) {
  constexpr int kRows = 4, kWidth = 32, kRowsAhead = 12;
  const int first_row = std::min(places.row[0], places.row[kLanes - 1]);
  const int first_column = std::min(places.column[0], places.column[kLanes - 1]);
  if (first_row + kRows > source.rows || first_column + kWidth > source.cols) return false;
  ShortLanes row, column;
  std::memcpy(&row, places.row, sizeof row);
  std::memcpy(&column, places.column, sizeof column);
  row -= static_cast<std::uint16_t>(first_row);
  column -= static_cast<std::uint16_t>(first_column);  // what is negative becomes large
  if (!Processor::allBelow(row, kRows - 1) || !Processor::allBelow(column, kWidth - 1)) return false;
  const ShortLanes place = (row << 5) + column;
  const std::uint8_t* const first = source.data + first_row * source.step[0] + first_column;
  // What is wanted some rows later: an image that has just arrived is in no cache.
  __builtin_prefetch(first + kRowsAhead * source.step[0]);
  Processor::fetchQuads(first, static_cast<std::ptrdiff_t>(source.step[0]),
                        __builtin_convertvector(place, IntLanes), quads);
  return true;
}

/// Between four pixels each, exactly, and rounded once.
template <typename Processor>
void blend(const IntLanes& quads, const Places& places, std::uint8_t* target) {
  ShortLanes x16, y16;
  Processor::load(places.column_fraction, x16);
  Processor::load(places.row_fraction, y16);
  const IntLanes x = __builtin_convertvector(x16, IntLanes), y = __builtin_convertvector(y16, IntLanes);
  // Of each quad a pair: above and below.
  const IntLanes x_of_both = x | x << 16, left_bytes = quads & 0x00ff00ff;
  const WideShorts &both = reinterpret_cast<const WideShorts&>(quads),
                   &left = reinterpret_cast<const WideShorts&>(left_bytes),
                   &share = reinterpret_cast<const WideShorts&>(x_of_both);
  const WideShorts between = (both << 8) + share * ((both >> 8) - left);  // modulo 2^16
  IntLanes sum;
  Processor::blendRows(reinterpret_cast<const IntLanes&>(between), y << 8, sum);
  Processor::storeBytes((sum + (1 << 15)) >> 16, target);
}

template <typename Processor>
void remapSixteen(const cv::Mat& source, const Places& places, std::uint8_t* target) {
  IntLanes quads;
  if constexpr (Processor::kShufflesBytes) {
    if (!fetchTogether<Processor>(source, places, quads)) fetchApart(source, places, quads);
  } else {
    fetchApart(source, places, quads);
  }
  blend<Processor>(quads, places, target);
}

/// The last ones of a row: some places are there twice.
template <typename Processor>
void remapRest(const cv::Mat& source, const Places& places, int count, std::uint8_t* target) {
  std::array<std::uint16_t, kLanes> column, row;
  std::array<std::uint8_t, kLanes> x, y, blended;
  for (int i = 0; i < kLanes; ++i) {
    const int from = std::min(i, count - 1);
    column[i] = places.column[from];
    row[i] = places.row[from];
    x[i] = places.column_fraction[from];
    y[i] = places.row_fraction[from];
  }
  remapSixteen<Processor>(source, {column.data(), row.data(), x.data(), y.data()}, blended.data());
  std::copy_n(blended.data(), count, target);
}

template <typename Processor>
void remapAll(const cv::Mat& source, const PixelSources& sources, cv::Mat& target) {
  for (int row = 0; row < target.rows; ++row) {
    std::uint8_t* const out = target.ptr<std::uint8_t>(row);
    const std::size_t first = static_cast<std::size_t>(row) * target.cols;
    for (int column = 0; column < target.cols; column += kLanes) {
      const std::size_t at = first + column;
      const Places places{sources.column.data() + at, sources.row.data() + at,
                          sources.column_fraction.data() + at, sources.row_fraction.data() + at};
      if (const int count = target.cols - column; count < kLanes)
        remapRest<Processor>(source, places, count, out + column);
      else
        remapSixteen<Processor>(source, places, out + column);
    }
  }
}

CARTVO_BY_PROCESSOR(void, remapHere, (const cv::Mat& source, const PixelSources& sources, cv::Mat& target),
                    (source, sources, target), remapAll)

}  // namespace

void remap(const cv::Mat& source, const PixelSources& sources, cv::Mat& target) {
  remapHere(source, sources, target);
}

}  // namespace cartvo
