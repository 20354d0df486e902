// FAST in windows with adaptive thresholds.
#include "vo_core/tracking/adaptive_detector.hpp"

#include <algorithm>
#include <cmath>

#include "common/threads/parallel_loop.hpp"

namespace cartvo::vo {
namespace {

constexpr int kInitialPasses = 6;  // adaptation passes over the first image before its corners are used

// Not functions, so that sorting inlines them.
constexpr auto kStronger = [](const Corner& a, const Corner& b) {
  if (a.score != b.score) return a.score > b.score;
  return a.y != b.y ? a.y < b.y : a.x < b.x;
};
constexpr auto kWeaker = [](const Corner& a, const Corner& b) { return kStronger(b, a); };

}  // namespace

AdaptiveDetector::AdaptiveDetector(const DetectionSettings& settings, int features,
                                   const cv::Size& image_size, double scale)
    : settings_(settings),
      features_(0),
      corner_target_(0.0),
      scale_(scale),
      initial_passes_(kInitialPasses),
      window_thresholds_(image_size, settings.window_rows),
      finders_(static_cast<std::size_t>(settings.window_rows)) {
  const int columns = settings.window_columns;
  const int rows = settings.window_rows;
  // The inverse of the windows' integer division: window c holds the pixels [c W / n, (c + 1) W / n).
  for (int x = 0; x < image_size.width; ++x)
    column_of_.push_back(((x + 1) * columns - 1) / image_size.width);
  for (int y = 0; y < image_size.height; ++y)
    row_of_.push_back(((y + 1) * rows - 1) / image_size.height);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const cv::Point from(column * image_size.width / columns, row * image_size.height / rows);
      const cv::Point to((column + 1) * image_size.width / columns, (row + 1) * image_size.height / rows);
      windows_.emplace_back(from, to);
    }
  }
  setTargetFeatureCount(features);
  // Thresholds change by factors: the geometric mean is as far from the minimum as from the maximum.
  thresholds_.assign(windows_.size(),
                     std::sqrt(1.0 * settings.minimum_threshold * settings.maximum_threshold));
  corner_counts_.assign(windows_.size(), 0);
  wanted_.resize(windows_.size());
  // Reserves memory for whatever an image may show: pages that are not written cost nothing.
  std::size_t most = 0;
  for (const cv::Rect& window : windows_) {
    corners_.emplace_back().reserve(maximumCorners(window.width, window.height));
    most += corners_.back().capacity();
  }
  remaining_.reserve(most);
  for (int row = 0; row < rows; ++row)
    finders_[row].reserve(image_size.width, windows_[static_cast<std::size_t>(row) * columns].height);
}

void AdaptiveDetector::setTargetFeatureCount(int features) {
  features_ = features;
  chosen_.reserve(features);
  corner_target_ = settings_.corners_per_feature * features / static_cast<double>(windows_.size());
}

int AdaptiveDetector::threshold(int index) const {
  return static_cast<int>(std::lround(thresholds_[index]));
}

void AdaptiveDetector::adaptThreshold(int index, int corners) {
  corner_counts_[index] = corners;
  const double ratio = (corners + 1.0) / (corner_target_ + 1.0);
  const double factor = std::pow(ratio, settings_.adaptation_exponent);
  thresholds_[index] = std::clamp<double>(thresholds_[index] * factor, settings_.minimum_threshold,
                                          settings_.maximum_threshold);
}

int AdaptiveDetector::windowAt(double x, double y) const {
  const int pixel_x = std::clamp(static_cast<int>(x), 0, static_cast<int>(column_of_.size()) - 1);
  const int pixel_y = std::clamp(static_cast<int>(y), 0, static_cast<int>(row_of_.size()) - 1);
  return row_of_[pixel_y] * settings_.window_columns + column_of_[pixel_x];
}

void AdaptiveDetector::findCorners(const DetectionImage& image, const std::vector<int>& wanted) {
  for (int i = 0; i < windowCount(); ++i) {
    window_thresholds_.set(windows_[i], wanted[i] > 0 ? static_cast<std::uint8_t>(threshold(i)) : kNoCorners);
    corners_[i].clear();
  }
  const auto is_masked = [&](const Corner& corner) {
    return image.mask != nullptr &&
           !image.mask->allows(scale_ * Eigen::Vector2d(corner.x, corner.y), image.level);
  };
  forEachIndex(finders_.size(), [&](std::size_t row) {
    const std::size_t first = row * settings_.window_columns;
    const cv::Range rows(windows_[first].y, windows_[first].br().y);
    for (const Corner& corner : finders_[row].find(image.pixels, rows, window_thresholds_))
      if (!is_masked(corner)) corners_[windowAt(corner.x, corner.y)].push_back(corner);
    for (std::size_t i = first; i < first + settings_.window_columns; ++i)
      std::make_heap(corners_[i].begin(), corners_[i].end(), kWeaker);
  });
  for (int i = 0; i < windowCount(); ++i)
    if (wanted[i] > 0) adaptThreshold(i, static_cast<int>(corners_[i].size()));
}

const std::vector<Corner>& AdaptiveDetector::detect(const DetectionImage& image,
                                                    const std::vector<Eigen::Vector2d>& alive,
                                                    SpacingGrid& spacing) {
  // Rounds cumulatively, so that the numbers add up exactly.
  const auto up_to = [&](int window) {
    return std::lround(features_ * (window / static_cast<double>(windowCount())));
  };
  for (int i = 0; i < windowCount(); ++i)
    wanted_[i] = static_cast<int>(up_to(i + 1) - up_to(i));
  for (const Eigen::Vector2d& pixel : alive)
    --wanted_[windowAt(pixel.x(), pixel.y())];
  return detect(image, wanted_, std::max(features_ - static_cast<int>(alive.size()), 0), spacing);
}

const std::vector<Corner>& AdaptiveDetector::detect(const DetectionImage& image,
                                                    const std::vector<int>& wanted, int room,
                                                    SpacingGrid& spacing) {
  for (; initial_passes_ > 0; --initial_passes_)
    findCorners(image, wanted);
  findCorners(image, wanted);

  chosen_.clear();
  remaining_.clear();
  for (int i = 0; i < windowCount(); ++i) {
    std::vector<Corner>& corners = corners_[i];
    room -= chooseFrom(corners, std::min(wanted[i], room), spacing);
    remaining_.insert(remaining_.end(), corners.begin(), corners.end());
  }
  std::make_heap(remaining_.begin(), remaining_.end(), kWeaker);
  chooseFrom(remaining_, room, spacing);
  return chosen_;
}

int AdaptiveDetector::chooseFrom(std::vector<Corner>& heap, int wanted, SpacingGrid& spacing) {
  int chosen = 0;
  while (chosen < wanted && !heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), kWeaker);
    const Corner corner = heap.back();
    heap.pop_back();
    if (!spacing.insert(scale_ * Eigen::Vector2d(corner.x, corner.y))) continue;
    chosen_.push_back(corner);
    ++chosen;
  }
  return chosen;
}

}  // namespace cartvo::vo
