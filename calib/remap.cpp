#include "calib/remap.hpp"

#include <algorithm>
#include <array>

namespace cartvo {
namespace {

constexpr int kBlock =
    64;  // pixels gathered at a time: small enough to stay in registers' reach, the first cache

/// The four raw pixels around each source of a block.
struct Neighbours {
  std::array<std::uint8_t, kBlock> top_left, top_right, bottom_left, bottom_right;
};

/// Gathering is what no compiler vectorises without processor-specific instructions; it stands alone.
void gather(const cv::Mat& source, const std::uint16_t* column, const std::uint16_t* row, int count,
            Neighbours& neighbours) {
  const std::size_t stride = source.step[0];
  for (int i = 0; i < count; ++i) {
    const std::uint8_t* const top = source.data + row[i] * stride + column[i];
    const std::uint8_t* const bottom = top + stride;
    neighbours.top_left[i] = top[0];
    neighbours.top_right[i] = top[1];
    neighbours.bottom_left[i] = bottom[0];
    neighbours.bottom_right[i] = bottom[1];
  }
}

/// Vectorised by the compiler: no branch, no index but i, always a whole block.
void blend(const Neighbours& neighbours, const std::uint8_t* __restrict column_fraction,
           const std::uint8_t* __restrict row_fraction, std::uint8_t* __restrict target) {
  for (int i = 0; i < kBlock; ++i) {
    const std::uint16_t x = column_fraction[i], y = row_fraction[i];
    const auto top =
        static_cast<std::uint16_t>(neighbours.top_left[i] * (256 - x) + neighbours.top_right[i] * x);
    const auto bottom =
        static_cast<std::uint16_t>(neighbours.bottom_left[i] * (256 - x) + neighbours.bottom_right[i] * x);
    const std::uint32_t sum = std::uint32_t{top} * (256u - y) + std::uint32_t{bottom} * y;
    target[i] = static_cast<std::uint8_t>((sum + (1u << 15)) >> 16);
  }
}

}  // namespace

void remap(const cv::Mat& source, const PixelSources& sources, cv::Mat& target) {
  Neighbours neighbours{};
  for (int row = 0; row < target.rows; ++row) {
    std::uint8_t* const out = target.ptr<std::uint8_t>(row);
    const std::size_t first = static_cast<std::size_t>(row) * target.cols;
    for (int column = 0; column < target.cols; column += kBlock) {
      const std::size_t at = first + column;
      const int count = std::min(kBlock, target.cols - column);
      gather(source, sources.column.data() + at, sources.row.data() + at, count, neighbours);
      if (count == kBlock) {
        blend(neighbours, sources.column_fraction.data() + at, sources.row_fraction.data() + at,
              out + column);
        continue;
      }
      std::array<std::uint8_t, kBlock> x{}, y{}, blended{};
      std::copy_n(sources.column_fraction.data() + at, count, x.data());
      std::copy_n(sources.row_fraction.data() + at, count, y.data());
      blend(neighbours, x.data(), y.data(), blended.data());
      std::copy_n(blended.data(), count, out + column);
    }
  }
}

}  // namespace cartvo
