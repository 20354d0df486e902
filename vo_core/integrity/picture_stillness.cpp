// Comparison of patches with their surroundings in a later image.
#include "vo_core/integrity/picture_stillness.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "vo_core/fixed_constants.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo::vo {
namespace {

constexpr int kColumns = 12, kRows = 8;  // cells
constexpr int kShift = 2;                // px: less is no motion that an encoder could not feign
constexpr int kClip = 24;                // grey levels: a hot pixel does not outvote a patch
constexpr int kTexture = 3;              // grey levels, mean difference from the surroundings; less is noise
constexpr double kInPlace = 0.6;         // share of the difference around it, of a patch that is still
constexpr int kPairs = 10;               // after which patches are taken anew
struct Offset {
  int x, y;
};
constexpr std::array<Offset, 8> kAround{{{kShift, 0},
                                         {kShift, kShift},
                                         {0, kShift},
                                         {-kShift, kShift},
                                         {-kShift, 0},
                                         {-kShift, -kShift},
                                         {0, -kShift},
                                         {kShift, -kShift}}};
constexpr std::array<Offset, 5> kPlaces{{{0, 0}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};  // in a cell

}  // namespace

/// Sum of clipped differences, without that of the brightness.
int PicturePatches::difference(const Patch& patch, const cv::Mat& image, cv::Point shift) {
  std::array<int, kSize * kSize> differences;
  int sum = 0;
  for (int y = 0; y < kSize; ++y) {
    const std::uint8_t* row =
        image.ptr<std::uint8_t>(patch.corner.y + shift.y + y) + patch.corner.x + shift.x;
    for (int x = 0; x < kSize; ++x) {
      const int i = y * kSize + x;
      differences[i] = row[x] - patch.pixels[i];
      sum += differences[i];
    }
  }
  const int mean = sum / (kSize * kSize);
  int clipped = 0;
  for (const int difference : differences)
    clipped += std::min(std::abs(difference - mean), kClip);
  return clipped;
}

/// The smallest difference from a place around the patch's own.
int PicturePatches::differenceAround(const Patch& patch, const cv::Mat& image) {
  int smallest = std::numeric_limits<int>::max();
  for (const Offset& shift : kAround)
    smallest = std::min(smallest, difference(patch, image, {shift.x, shift.y}));
  return smallest;
}

void PicturePatches::take(const cv::Mat& image, const cv::Mat& mask) {
  patches_.clear();
  const cv::Size cell(image.cols / kColumns, image.rows / kRows);
  if (std::min(cell.width, cell.height) < kSize + 2 * kShift) return;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const cv::Point middle((i % kColumns) * cell.width + cell.width / 2,
                           (i / kColumns) * cell.height + cell.height / 2);
    Patch best;
    int texture = 0;
    for (const Offset& place : kPlaces) {
      Patch patch;
      patch.corner = middle - cv::Point(kSize / 2, kSize / 2) +
                     cv::Point(place.x * (cell.width - kSize - 2 * kShift) / 2,
                               place.y * (cell.height - kSize - 2 * kShift) / 2);
      const cv::Rect area(patch.corner, cv::Size(kSize, kSize));
      if (!mask.empty() && mask.at<std::uint8_t>(patch.corner + cv::Point(kSize / 2, kSize / 2)) == 0)
        continue;
      const cv::Mat pixels = image(area);
      for (int y = 0; y < kSize; ++y)
        std::copy_n(pixels.ptr<std::uint8_t>(y), kSize, &patch.pixels[y * kSize]);
      const int around = differenceAround(patch, image);
      if (around <= texture) continue;
      texture = around;
      best = patch;
    }
    if (texture > kTexture * kSize * kSize) patches_.push_back(best);
  }
}

std::optional<double> PicturePatches::stillShare(const cv::Mat& image) const {
  int still = 0, moved = 0;
  for (const Patch& patch : patches_) {
    const int here = difference(patch, image, {}), around = differenceAround(patch, image);
    if (here < kInPlace * around)
      ++still;
    else if (here >= around)
      ++moved;
  }
  if (still + moved < stereo_look::kMinimumMatches) return std::nullopt;
  return static_cast<double>(still) / (still + moved);
}

void PictureStillness::update(const StereoImages& images, const StereoMasks& masks) {
  const auto left = left_.stillShare(images.left), right = right_.stillShare(images.right);
  const auto is_still = [](std::optional<double> share) {
    return share && *share >= stereo_look::kAgreeingShare;
  };
  const auto has_moved = [](std::optional<double> share) { return !share || *share <= kMajority; };
  if ((alone_ == Alone::left && !is_still(left)) || (alone_ == Alone::right && !is_still(right)))
    alone_ = Alone::none;
  const bool moved = has_moved(left) || has_moved(right);
  if (!moved && ++pairs_ < kPairs) return;
  Alone seen = Alone::none;
  if (is_still(left) && right && has_moved(right)) seen = Alone::left;
  if (is_still(right) && left && has_moved(left)) seen = Alone::right;
  // Cameras that are exposed one after the other see a sudden stop one after the other, but once.
  if (seen != Alone::none && seen == seen_) alone_ = seen;
  if (!moved) alone_ = Alone::none;  // the cart stands
  seen_ = seen;
  pairs_ = 0;
  left_.take(images.left, masks.left);
  right_.take(images.right, masks.right);
}

}  // namespace cartvo::vo
