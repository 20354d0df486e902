// Bilinear remapping of images through lookup tables, sixteen pixels at a time.
#include "calib/rectification/remap.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "common/simd/bilinear_gather.hpp"

namespace cartvo::calib {
namespace {

/// Source positions of sixteen pixels.
struct Positions {
  const std::uint16_t *column, *row;
  const std::uint8_t *column_fraction, *row_fraction;
};

/// Loads the 2x2 pixels at each position, one position at a time: the pixel, the one to its right, below, and
/// below to the right, lowest byte first.
void gatherPixels(const cv::Mat& source, const Positions& positions, IntLanes& pixels) {
  ShortLanes row, column;
  std::memcpy(&row, positions.row, sizeof row);
  std::memcpy(&column, positions.column, sizeof column);
  const auto stride = static_cast<int>(source.step[0]);
  const IntLanes offset =
      __builtin_convertvector(row, IntLanes) * stride + __builtin_convertvector(column, IntLanes);
  gather2x2Scalar(source.data, stride, offset, kLanes, pixels);
}

/// Interpolates bilinearly between the 2x2 pixels, exactly, and rounds once.
void interpolate(const IntLanes& pixels, const Positions& positions, std::uint8_t* target) {
  ShortLanes x16, y16;
  LaneOperations::load(positions.column_fraction, x16);
  LaneOperations::load(positions.row_fraction, y16);
  const IntLanes x = __builtin_convertvector(x16, IntLanes), y = __builtin_convertvector(y16, IntLanes);
  // Interpolate along the rows: a pair of values for each position, above and below.
  const IntLanes x_of_both = x | x << 16, left_bytes = pixels & 0x00ff00ff;
  const WideShorts &both = reinterpret_cast<const WideShorts&>(pixels),
                   &left = reinterpret_cast<const WideShorts&>(left_bytes),
                   &share = reinterpret_cast<const WideShorts&>(x_of_both);
  const WideShorts between = (both << 8) + share * ((both >> 8) - left);  // modulo 2^16
  IntLanes sum;
  LaneOperations::blendRows(reinterpret_cast<const IntLanes&>(between), y << 8, sum);
  LaneOperations::storeBytes((sum + (1 << 15)) >> 16, target);
}

void remapSixteen(const cv::Mat& source, const Positions& positions, std::uint8_t* target) {
  IntLanes pixels;
  gatherPixels(source, positions, pixels);
  interpolate(pixels, positions, target);
}

/// Remaps the last `count` pixels of a row, padded to sixteen with copies of the last position.
void remapRest(const cv::Mat& source, const Positions& positions, int count, std::uint8_t* target) {
  std::array<std::uint16_t, kLanes> column, row;
  std::array<std::uint8_t, kLanes> x, y, blended;
  for (int i = 0; i < kLanes; ++i) {
    const int from = std::min(i, count - 1);
    column[i] = positions.column[from];
    row[i] = positions.row[from];
    x[i] = positions.column_fraction[from];
    y[i] = positions.row_fraction[from];
  }
  remapSixteen(source, {column.data(), row.data(), x.data(), y.data()}, blended.data());
  std::copy_n(blended.data(), count, target);
}

CARTVO_TARGET_CLONES void remapHere(const cv::Mat& source, const PixelSources& sources, cv::Mat& target) {
  for (int row = 0; row < target.rows; ++row) {
    std::uint8_t* const out = target.ptr<std::uint8_t>(row);
    const std::size_t first = static_cast<std::size_t>(row) * target.cols;
    for (int column = 0; column < target.cols; column += kLanes) {
      const std::size_t at = first + column;
      const Positions positions{sources.column.data() + at, sources.row.data() + at,
                                sources.column_fraction.data() + at, sources.row_fraction.data() + at};
      if (const int count = target.cols - column; count < kLanes)
        remapRest(source, positions, count, out + column);
      else
        remapSixteen(source, positions, out + column);
    }
  }
}

}  // namespace

void remap(const cv::Mat& source, const PixelSources& sources, cv::Mat& target) {
  remapHere(source, sources, target);
}

}  // namespace cartvo::calib
