// Which windows and which level of the pyramid new landmarks come from.
#include "vo_core/landmark_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cartvo {
namespace {

constexpr double kDoubt = 4.0;  // corners that a window is taken to have tried already, half of them in vain
constexpr double kLeastRate = 0.05;         // of a window in which nothing lasts, so that it is tried again
constexpr double kTriesRemembered = 60.0;   // of a window
constexpr double kPairsRemembered = 200.0;  // where nothing is tried
constexpr double kDecision = 8.0;           // power of what levels are worth by which they share a window

double highest(const LevelShares& worth) {
  return *std::max_element(worth.begin(), worth.end());
}

/// How levels of that worth share a window: nearly all goes to the best.
LevelShares decided(const LevelShares& worth) {
  LevelShares split;
  for (std::size_t level = 0; level < worth.size(); ++level)
    split[level] = std::pow(worth[level], kDecision);
  const double whole = std::accumulate(split.begin(), split.end(), 0.0);
  for (double& share : split)
    share /= whole;
  return split;
}

/// The same pixels, which are only read.
cv::Mat imageOf(const PyramidLevel& level) {
  return {level.height(), level.width(), CV_8UC1, const_cast<std::uint8_t*>(level.at(0, 0)),
          static_cast<std::size_t>(level.stride())};
}

}  // namespace

LandmarkDetector::LandmarkDetector(const DetectionSettings& settings, int features,
                                   const cv::Size& image_size)
    : features_(features) {
  for (int level = 0; level < settings.levels; ++level) {
    AdaptiveDetector detector(settings, features, levelSize(image_size, level), levelScale(level));
    const auto windows = static_cast<std::size_t>(detector.windowCount());
    levels_.push_back({std::move(detector), std::vector<Tries>(windows, Tries{kDoubt, 0.5 * kDoubt}),
                       std::vector<int>(windows)});
  }
  aimAt(features);
}

void LandmarkDetector::aimAt(int features) {
  features_ = features;
  corners_.reserve(features);
  for (Level& level : levels_)
    level.detector.aimAt(features);
}

int LandmarkDetector::windowOf(int level, const Eigen::Vector2d& pixel) const {
  const double scale = levelScale(level);
  return levels_[level].detector.windowAt(pixel.x() / scale, pixel.y() / scale);
}

void LandmarkDetector::learn(const Landmark& landmark, bool followed) {
  Tries& tries = levels_[landmark.level].tries[windowOf(landmark.level, landmark.host().left)];
  const double kept = 1.0 - 1.0 / kTriesRemembered;
  tries.tried = kept * tries.tried + 1.0;
  tries.followed = kept * tries.followed + (followed ? 1.0 : 0.0);
}

/// What has not been tried for long is in doubt again.
void LandmarkDetector::forget() {
  for (Level& level : levels_)
    for (Tries& tries : level.tries) {
      tries.tried += (kDoubt - tries.tried) / kPairsRemembered;
      tries.followed += (0.5 * kDoubt - tries.followed) / kPairsRemembered;
    }
}

LevelShares LandmarkDetector::worthOf(int window) const {
  LevelShares worth{};
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const Tries& tries = levels_[level].tries[window];
    const double scale = levelScale(static_cast<int>(level));
    worth[level] = std::max(tries.followed / tries.tried, kLeastRate) / (scale * scale);
  }
  return worth;
}

void LandmarkDetector::share() {
  const int windows = levels_.front().detector.windowCount();
  double sum = 0.0;
  for (int i = 0; i < windows; ++i)
    sum += highest(worthOf(i));
  LevelShares before{};  // so that they add up to features_ exactly
  for (int i = 0; i < windows; ++i) {
    const LevelShares worth = worthOf(i);
    const LevelShares split = decided(worth);
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      const double after = before[level] + features_ * highest(worth) / sum * split[level];
      levels_[level].wanted[i] = static_cast<int>(std::lround(after) - std::lround(before[level]));
      before[level] = after;
    }
  }
}

const std::vector<LandmarkCorner>& LandmarkDetector::detect(const ImagePyramid& image,
                                                            const std::vector<Landmark>& alive,
                                                            SpacingGrid& spacing) {
  share();
  forget();
  for (const Landmark& landmark : alive)
    --levels_[landmark.level].wanted[windowOf(landmark.level, landmark.last().left)];
  corners_.clear();
  // Coarse ones first, as many as are wanted; fine ones fill up what room is left.
  for (int index = static_cast<int>(levels_.size()) - 1; index >= 0; --index) {
    Level& level = levels_[index];
    if (index >= static_cast<int>(image.grey.size())) continue;  // too small to be halved
    int room = std::max(features_ - static_cast<int>(alive.size() + corners_.size()), 0);
    if (index > 0) {
      const int wanted = std::accumulate(level.wanted.begin(), level.wanted.end(), 0,
                                         [](int sum, int more) { return sum + std::max(more, 0); });
      if (wanted == 0) continue;
      room = std::min(room, wanted);
    }
    const double scale = levelScale(index);
    for (const Corner& corner :
         level.detector.detect(imageOf(image.grey[index]), level.wanted, room, spacing))
      corners_.push_back(
          {scale * Eigen::Vector2d(corner.x, corner.y), index, static_cast<float>(corner.score)});
  }
  return corners_;
}

}  // namespace cartvo
