// Gaussian and difference-of-Gaussian pyramids (P. Burt, E. Adelson, "The Laplacian pyramid as a compact
// image code", 1983) in integer arithmetic, with the same results as OpenCV.
#include "vo_core/image/image_pyramid.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "vo_core/simd/vector_widths.hpp"

namespace cartvo::vo {
namespace {

constexpr int kTaps = 5;                // of both filters
constexpr int kMinimumSideToHalve = 8;  // px
constexpr int kDogGain = 3;  // so that weak texture uses the range of a byte; strong texture saturates
// Taps of the Gaussian with sigma 1 px, times 128, from the outermost to the centre.
constexpr std::uint16_t kGaussian[] = {7, 31, 52};

int wholeBlocks(int width) {
  return (width + PyramidLevel::kBlock - 1) / PyramidLevel::kBlock * PyramidLevel::kBlock;
}

/// Index of the pixel that the border shows at position i of a row of n pixels (reflection without doubling
/// the edge pixel).
int mirrored(int i, int n) {
  if (n == 1) return 0;
  const int period = 2 * (n - 1);
  const int place = (i % period + period) % period;
  return std::min(place, period - place);
}

void mirrorEight(const std::uint8_t* from, std::uint8_t* to) {
  std::uint64_t pixels;
  std::memcpy(&pixels, from, sizeof pixels);
  pixels = __builtin_bswap64(pixels);
  std::memcpy(to, &pixels, sizeof pixels);
}

/// Horizontal binomial filter 1 4 6 4 1 at every other column of a row; the result is times 16.
template <int kSize>
void halveAcross(const std::uint8_t* row, int half_width, std::uint16_t* sums) {
  using Pairs = typename ByteVectors<kSize>::Shorts;  // pairs of an even and an odd column
  static_assert(std::endian::native == std::endian::little);
  for (int x = 0; x < half_width; x += kSize / 2) {
    Pairs before, here, after;
    std::memcpy(&before, row + 2 * x - 2, sizeof before);
    std::memcpy(&here, row + 2 * x, sizeof here);
    std::memcpy(&after, row + 2 * x + 2, sizeof after);
    const Pairs odd = (before >> 8) + (here >> 8);
    const Pairs even = here & 255;
    const Pairs sum = (before & 255) + (after & 255) + (odd << 2) + (even << 2) + (even << 1);
    std::memcpy(sums + x, &sum, sizeof sum);
  }
}

using RowSums = std::array<const std::uint16_t*, kTaps>;  // from top to bottom

/// Vertical binomial filter. The sum of all weights is 256, so no sum exceeds sixteen bits.
template <int kSize>
void halveDown(const RowSums& rows, int half_width, std::uint8_t* out) {
  using Shorts = typename ByteVectors<kSize>::Shorts;
  using HalfBytes = typename ByteVectors<kSize / 2>::Bytes;
  for (int x = 0; x < half_width; x += kSize / 2) {
    Shorts row[kTaps];
#pragma GCC unroll 5
    for (int tap = 0; tap < kTaps; ++tap)
      std::memcpy(&row[tap], rows[tap] + x, sizeof row[tap]);
    const Shorts sum =
        row[0] + row[4] + ((row[1] + row[3]) << 2) + (row[2] << 2) + (row[2] << 1) + std::uint16_t{128};
    const HalfBytes rounded = __builtin_convertvector(sum >> 8, HalfBytes);
    std::memcpy(out + x, &rounded, sizeof rounded);
  }
}

/// Horizontal Gaussian filter; the result is times 128.
template <int kSize>
void blurAcross(const std::uint8_t* row, int width, std::uint16_t* sums) {
  using Shorts = typename ByteVectors<kSize>::Shorts;
  using HalfBytes = typename ByteVectors<kSize / 2>::Bytes;
  for (int x = 0; x < width; x += kSize / 2) {
    Shorts pixel[kTaps];
#pragma GCC unroll 5
    for (int tap = 0; tap < kTaps; ++tap) {
      HalfBytes bytes;
      std::memcpy(&bytes, row + x + tap - kTaps / 2, sizeof bytes);
      pixel[tap] = __builtin_convertvector(bytes, Shorts);
    }
    const Shorts sum =
        kGaussian[0] * (pixel[0] + pixel[4]) + kGaussian[1] * (pixel[1] + pixel[3]) + kGaussian[2] * pixel[2];
    std::memcpy(sums + x, &sum, sizeof sum);
  }
}

/// Vertical Gaussian filter and difference of the row from it.
template <int kSize>
void differenceDown(const RowSums& rows, const std::uint8_t* row, int width, std::uint8_t* out) {
  using Shorts = typename ByteVectors<kSize>::Shorts;
  using SignedShorts = typename ByteVectors<kSize>::SignedShorts;
  using HalfBytes = typename ByteVectors<kSize / 2>::Bytes;
  for (int x = 0; x < width; x += kSize / 2) {
    // Weighted sums take 22 bits. Each input is split into 128 h + l; h and l are summed in sixteen bits
    // each.
    Shorts high{}, low{};
#pragma GCC unroll 5
    for (int tap = 0; tap <= kTaps / 2; ++tap) {
      Shorts sum, other{};
      std::memcpy(&sum, rows[tap] + x, sizeof sum);
      if (tap != kTaps / 2) std::memcpy(&other, rows[kTaps - 1 - tap] + x, sizeof other);
      sum += other;
      high += kGaussian[tap] * (sum >> 7);
      low += kGaussian[tap] * (sum & 127);
    }
    const Shorts blurred = (high + ((low + std::uint16_t{64 * 128}) >> 7)) >> 7;  // rounded
    HalfBytes bytes;
    std::memcpy(&bytes, row + x, sizeof bytes);
    const Shorts grey = __builtin_convertvector(bytes, Shorts);
    SignedShorts difference = kDogGain * (reinterpret_cast<const SignedShorts&>(grey) -
                                          reinterpret_cast<const SignedShorts&>(blurred)) +
                              128;
    difference = difference < 0 ? SignedShorts{} : difference;
    difference = difference > 255 ? SignedShorts{} + 255 : difference;
    bytes = __builtin_convertvector(difference, HalfBytes);
    std::memcpy(out + x, &bytes, sizeof bytes);
  }
}

CARTVO_BY_VECTOR_WIDTH(void halveRow(const std::uint8_t* row, int half_width, std::uint16_t* sums),
                       halveAcross<kSize>(row, half_width, sums);)
CARTVO_BY_VECTOR_WIDTH(void halveRows(const RowSums& rows, int half_width, std::uint8_t* out),
                       halveDown<kSize>(rows, half_width, out);)
CARTVO_BY_VECTOR_WIDTH(void blurRow(const std::uint8_t* row, int width, std::uint16_t* sums),
                       blurAcross<kSize>(row, width, sums);)
CARTVO_BY_VECTOR_WIDTH(void differFromBlur(const RowSums& rows, const std::uint8_t* row, int width,
                                           std::uint8_t* out),
                       differenceDown<kSize>(rows, row, width, out);)

/// Ring buffer of the last rows after the horizontal filter.
class RowFilter {
 public:
  RowFilter(std::vector<std::uint16_t>& memory, int width) : width_(wholeBlocks(width)) {
    memory.resize(std::max(memory.size(), static_cast<std::size_t>(kTaps) * width_));
    memory_ = memory.data();
  }
  /// Sums of row y; they replace those of row y - kTaps.
  std::uint16_t* rowSums(int y) const { return memory_ + (y + kTaps) % kTaps * width_; }
  RowSums around(int y) const {
    return {rowSums(y - 2), rowSums(y - 1), rowSums(y), rowSums(y + 1), rowSums(y + 2)};
  }

 private:
  std::uint16_t* memory_;
  int width_;
};

/// Equals cv::pyrDown; `level` needs its border.
void halve(const PyramidLevel& level, std::vector<std::uint16_t>& memory, PyramidLevel& half) {
  const RowFilter sums(memory, half.width());
  int next = -kTaps / 2;  // next row to filter
  for (int y = 0; y < half.height(); ++y) {
    for (; next <= 2 * y + kTaps / 2; ++next)
      halveRow(level.at(0, next), half.width(), sums.rowSums(next));
    halveRows(sums.around(2 * y), half.width(), half.row(y));
  }
  half.writeBorder();
}

/// kDogGain times the difference between a level and its cv::GaussianBlur; `level` needs its border.
void differenceOfGaussians(const PyramidLevel& level, std::vector<std::uint16_t>& memory, PyramidLevel& dog) {
  const RowFilter sums(memory, level.width());
  int next = -kTaps / 2;
  for (int y = 0; y < level.height(); ++y) {
    for (; next <= y + kTaps / 2; ++next)
      blurRow(level.at(0, next), level.width(), sums.rowSums(next));
    differFromBlur(sums.around(y), level.at(0, y), level.width(), dog.row(y));
  }
  dog.writeBorder();
}

/// Sizes of at most `maximum` levels.
std::vector<cv::Size> levelSizes(const cv::Size& image, int maximum) {
  std::vector<cv::Size> sizes{image};
  while (static_cast<int>(sizes.size()) < maximum &&
         std::min(sizes.back().width, sizes.back().height) >= kMinimumSideToHalve)
    sizes.push_back(levelSize(image, static_cast<int>(sizes.size())));
  return sizes;
}

std::shared_ptr<ImagePyramid> emptyPyramid(const std::vector<cv::Size>& sizes, int grey_levels) {
  auto pyramid = std::make_shared<ImagePyramid>();
  for (int index = 0; index < static_cast<int>(sizes.size()); ++index) {
    if (index < grey_levels) pyramid->grey.emplace_back(sizes[index]);
    if (index >= kFinestDog && index < kFinestDog + kDogLevels) pyramid->dog.emplace_back(sizes[index]);
  }
  return pyramid;
}

}  // namespace

PyramidLevel::PyramidLevel(const cv::Size& size) : width_(size.width), height_(size.height) {
  // Pixel (0, 0) begins a block. One block fits between the end of a row and the border of the next row.
  static_assert(kBorder < kBlock);
  stride_ = wholeBlocks(kBlock + width_ + kBlock);
  const std::ptrdiff_t size_in_pixels = stride_ * (height_ + 2 * kBorder) + 2 * kBlock;
  memory_ = std::shared_ptr<Block[]>(new Block[static_cast<std::size_t>(size_in_pixels / kBlock)]);
  origin_ = memory_[0].pixels.data() + kBorder * stride_ + kBlock;
}

void PyramidLevel::writeBorder() {
  for (int y = 0; y < height_; ++y) {
    std::uint8_t* const first = row(y);
    std::uint8_t* const last = first + width_ - 1;
    if (width_ > kBorder) {
      static_assert(kBorder % 8 == 0);
      for (int i = 0; i < kBorder; i += 8) {
        mirrorEight(first + 1 + i, first - 8 - i);
        mirrorEight(last - 8 - i, last + 1 + i);
      }
    } else {
      for (int i = 1; i <= kBorder; ++i) {
        first[-i] = first[mirrored(-i, width_)];
        last[i] = first[mirrored(width_ - 1 + i, width_)];
      }
    }
  }
  const std::size_t padded_width = static_cast<std::size_t>(width_) + 2 * kBorder;
  const auto copy_row = [&](int from, int to) {
    std::memcpy(row(to) - kBorder, row(from) - kBorder, padded_width);
  };
  for (int i = 1; i <= kBorder; ++i) {
    copy_row(mirrored(-i, height_), -i);
    copy_row(mirrored(height_ - 1 + i, height_), height_ - 1 + i);
  }
}

cv::Mat PyramidLease::image() const {
  if (!pyramid_) return {};
  PyramidLevel& level = pyramid_->grey.front();
  return {level.height(), level.width(), CV_8UC1, level.row(0), static_cast<std::size_t>(level.stride())};
}

bool PyramidLease::holds(const cv::Mat& image) const {
  return pyramid_ && image.data == pyramid_->grey.front().row(0);
}

/// Returns the first pyramid that no one else owns, so that the same memory is reused while it is warm; adds
/// one if all are in use.
std::shared_ptr<ImagePyramid> PyramidPool::findFree(const cv::Size& size) {
  auto free = std::find_if(pyramids_.begin(), pyramids_.end(),
                           [](const auto& pyramid) { return pyramid.use_count() == 1; });
  if (free == pyramids_.end()) {
    const auto sizes = levelSizes(size, std::max(grey_levels_, kFinestDog + kDogLevels));
    free = pyramids_.insert(free, emptyPyramid(sizes, grey_levels_));
    (*free)->mask = mask_;
    for (std::size_t level = (*free)->grey.size() + halves_.size(); level < sizes.size(); ++level)
      halves_.emplace_back(sizes[level]);
  }
  return *free;
}

PyramidLease PyramidPool::lease(const cv::Size& size) {
  return PyramidLease(findFree(size));
}

SharedPyramid PyramidPool::build(PyramidLease lease) {
  fill(*lease.pyramid_);
  return std::move(lease.pyramid_);
}

SharedPyramid PyramidPool::build(const cv::Mat& image) {
  PyramidLease copy = lease(image.size());
  PyramidLevel& level = copy.pyramid_->grey.front();
  for (int y = 0; y < image.rows; ++y)
    std::memcpy(level.row(y), image.ptr(y), static_cast<std::size_t>(image.cols));
  return build(std::move(copy));
}

/// Computes all levels from the image.
void PyramidPool::fill(ImagePyramid& pyramid) {
  PyramidLevel* level = &pyramid.grey.front();
  level->writeBorder();
  const std::size_t greys = pyramid.grey.size();
  for (std::size_t index = 1; index < greys + halves_.size(); ++index) {
    PyramidLevel& half = index < greys ? pyramid.grey[index] : halves_[index - greys];
    halve(*level, row_sums_, half);
    level = &half;
    if (index >= kFinestDog && index - kFinestDog < pyramid.dog.size())
      differenceOfGaussians(half, row_sums_, pyramid.dog[index - kFinestDog]);
  }
}

ImagePyramid buildPyramid(const cv::Mat& image, int grey_levels) {
  return *PyramidPool(grey_levels).build(image);
}

}  // namespace cartvo::vo
