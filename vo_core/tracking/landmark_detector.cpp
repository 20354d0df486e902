// Distribution of new landmarks over windows and pyramid levels by the tracking success of earlier ones.
#include "vo_core/tracking/landmark_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cartvo::vo {
namespace {

double highest(const LevelShares& utility) {
  return *std::max_element(utility.begin(), utility.end());
}

/// Shares of the levels in a window by their utilities: nearly all goes to the best.
LevelShares sharpenedShares(const LevelShares& utility, double sharpness) {
  LevelShares split;
  for (std::size_t level = 0; level < utility.size(); ++level)
    split[level] = std::pow(utility[level], sharpness);
  const double whole = std::accumulate(split.begin(), split.end(), 0.0);
  for (double& share : split)
    share /= whole;
  return split;
}

/// Image header for the pixels of a level, which are only read.
cv::Mat imageOf(const PyramidLevel& level) {
  return {level.height(), level.width(), CV_8UC1, const_cast<std::uint8_t*>(level.at(0, 0)),
          static_cast<std::size_t>(level.stride())};
}

}  // namespace

LandmarkDetector::LandmarkDetector(const DetectionSettings& settings, int features,
                                   const cv::Size& image_size)
    : settings_(settings), features_(features) {
  for (int level = 0; level < settings.levels; ++level) {
    AdaptiveDetector detector(settings, features, levelSize(image_size, level), levelScale(level));
    const auto windows = static_cast<std::size_t>(detector.windowCount());
    levels_.push_back({std::move(detector), std::vector<TrialCounts>(windows), std::vector<int>(windows)});
  }
  setTargetFeatureCount(features);
}

void LandmarkDetector::setTargetFeatureCount(int features) {
  features_ = features;
  corners_.reserve(features);
  for (Level& level : levels_)
    level.detector.setTargetFeatureCount(features);
}

int LandmarkDetector::windowOf(int level, const Eigen::Vector2d& pixel) const {
  const double scale = levelScale(level);
  return levels_[level].detector.windowAt(pixel.x() / scale, pixel.y() / scale);
}

void LandmarkDetector::recordOutcome(const Landmark& landmark, bool tracked) {
  TrialCounts& trials = levels_[landmark.level].trials[windowOf(landmark.level, landmark.anchor().left)];
  trials.attempted += 1.0;
  trials.tracked += tracked ? 1.0 : 0.0;
}

/// Forgets: what has not been tried for long is uncertain again.
void LandmarkDetector::decayTrials() {
  const double kept = 1.0 - 1.0 / settings_.trial_memory;
  for (Level& level : levels_)
    for (TrialCounts& trials : level.trials) {
      trials.attempted *= kept;
      trials.tracked *= kept;
    }
}

LevelShares LandmarkDetector::utilityOf(int window) const {
  LevelShares utility{};
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const TrialCounts& trials = levels_[level].trials[window];
    const double scale = levelScale(static_cast<int>(level));
    utility[level] = (trials.tracked + 1.0) / ((trials.attempted + 2.0) * scale * scale);
  }
  return utility;
}

void LandmarkDetector::distributeTargets() {
  const int windows = levels_.front().detector.windowCount();
  double sum = 0.0;
  for (int i = 0; i < windows; ++i)
    sum += highest(utilityOf(i));
  LevelShares before{};  // cumulative, so that the rounded numbers add up to features_ exactly
  for (int i = 0; i < windows; ++i) {
    const LevelShares utility = utilityOf(i);
    const LevelShares split = sharpenedShares(utility, settings_.level_sharpness);
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      const double after = before[level] + features_ * highest(utility) / sum * split[level];
      levels_[level].wanted[i] = static_cast<int>(std::lround(after) - std::lround(before[level]));
      before[level] = after;
    }
  }
}

const std::vector<LandmarkCorner>& LandmarkDetector::detect(const ImagePyramid& image,
                                                            const std::vector<Landmark>& alive,
                                                            SpacingGrid& spacing) {
  distributeTargets();
  decayTrials();
  for (const Landmark& landmark : alive)
    --levels_[landmark.level].wanted[windowOf(landmark.level, landmark.last().left)];
  corners_.clear();
  // Coarse corners first, as many as are wanted; fine ones take the remaining room.
  for (int index = static_cast<int>(levels_.size()) - 1; index >= 0; --index) {
    Level& level = levels_[index];
    if (index >= static_cast<int>(image.grey.size())) continue;  // the image is too small to have the level
    int room = std::max(features_ - static_cast<int>(alive.size() + corners_.size()), 0);
    if (index > 0) {
      const int wanted = std::accumulate(level.wanted.begin(), level.wanted.end(), 0,
                                         [](int sum, int more) { return sum + std::max(more, 0); });
      if (wanted == 0) continue;
      room = std::min(room, wanted);
    }
    const double scale = levelScale(index);
    for (const Corner& corner :
         level.detector.detect({imageOf(image.grey[index]), &image.mask, index}, level.wanted, room, spacing))
      corners_.push_back(
          {scale * Eigen::Vector2d(corner.x, corner.y), index, static_cast<float>(corner.score)});
  }
  return corners_;
}

}  // namespace cartvo::vo
