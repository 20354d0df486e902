// Detection, tracking, stereo matching and removal of features.
#include "vo_core/thesis/feature_set.hpp"

#include <algorithm>
#include <cmath>

#include "common/threads/parallel_loop.hpp"
#include "vo_core/stereo/stereo_matcher.hpp"
#include "vo_core/thesis/klt.hpp"

namespace cartvo::vo {
namespace {

constexpr double kAssumedDepth = 1000.0;  // m, assumed depth of a feature without a disparity
constexpr int kLevelsIfPredicted =
    2;  // pyramid levels for a predicted position, which is right to some 10 px
constexpr double kOutsideMargin = 8.0;  // px; a feature predicted farther outside the image is dropped

}  // namespace

FeatureSet::FeatureSet(const StereoCamera& camera, const OdometrySettings& settings)
    : camera_(camera),
      settings_(settings),
      detector_(settings.detection, settings.features, cv::Size(camera.width, camera.height)) {}

int FeatureSet::seenCount() const {
  return static_cast<int>(std::count_if(features_.begin(), features_.end(),
                                        [&](const Feature& feature) { return isSeen(feature); }));
}

int FeatureSet::matchedCount() const {
  return static_cast<int>(std::count_if(features_.begin(), features_.end(), [&](const Feature& feature) {
    return isSeen(feature) && feature.last().matched();
  }));
}

Eigen::Vector2d FeatureSet::predictPixel(const Feature& feature, const FrameWindow& window,
                                         const std::optional<Eigen::Isometry3d>& T_world_camera) const {
  const FeatureObservation& last = feature.last();
  const FrameRecord* frame = window.find(last.frame);
  if (!T_world_camera || frame == nullptr || !frame->T_world_camera) return last.left;
  const double disparity = camera_.focal_length * camera_.baseline / kAssumedDepth;
  const Eigen::Vector3d point =
      last.matched() ? last.point : cartvo::vo::triangulate(camera_, {last.left, disparity});
  const Eigen::Vector3d predicted = T_world_camera->inverse() * *frame->T_world_camera * point;
  if (predicted.z() < 0.1) return {-1e6, -1e6};  // behind the camera
  return project(camera_, predicted);
}

void FeatureSet::track(const ImagePyramid& left, std::int64_t frame, const FrameWindow& window,
                       const std::optional<Eigen::Isometry3d>& T_world_camera) {
  frame_ = frame;
  std::vector<KltResult> results(features_.size());
  std::vector<unsigned char> dropped(features_.size(), 0);
  forEachIndex(features_.size(), [&](std::size_t i) {
    const Feature& feature = features_[i];
    const FrameRecord* before = window.find(feature.last().frame);
    if (before == nullptr) {
      dropped[i] = 1;
      return;
    }
    const Eigen::Vector2d guess = predictPixel(feature, window, T_world_camera);
    if (guess.x() < -kOutsideMargin || guess.y() < -kOutsideMargin ||
        guess.x() > camera_.width + kOutsideMargin || guess.y() > camera_.height + kOutsideMargin) {
      dropped[i] = 1;
      return;
    }
    const bool predicted = T_world_camera && before->T_world_camera && feature.last().matched();
    const int all_levels = settings_.tracking.levels;
    const auto track_in_levels = [&](int levels) {
      return trackPatch(before->left, left, feature.last().left, guess, levels, settings_.tracking);
    };
    results[i] = track_in_levels(predicted ? std::min(kLevelsIfPredicted, all_levels) : all_levels);
    // A lost feature is searched only where it is predicted; one of the previous pair may move by itself.
    if (!results[i].found && predicted && before == window.newest()) results[i] = track_in_levels(all_levels);
    if (results[i].found) results[i].found = left.mask.allows(results[i].position, 0);
    // Without a depth the position of a lost feature cannot be predicted: hardly any is found again.
    const int search_again = feature.last().matched() ? settings_.tracking.search_again : 0;
    dropped[i] = !results[i].found && frame - feature.last().frame > search_again ? 1 : 0;
  });

  std::vector<Feature> kept;
  kept.reserve(features_.size());
  for (std::size_t i = 0; i < features_.size(); ++i) {
    if (dropped[i] != 0) continue;
    kept.push_back(features_[i]);
    if (!results[i].found) continue;
    FeatureObservation observation;
    observation.frame = frame;
    observation.left = results[i].position;
    kept.back().observe(observation);
  }
  features_ = std::move(kept);
}

void FeatureSet::enforceMinimumDistance(SpacingGrid& spacing) {
  std::stable_sort(features_.begin(), features_.end(),
                   [](const Feature& a, const Feature& b) { return a.age() > b.age(); });
  std::erase_if(features_, [&](const Feature& feature) {
    return isSeen(feature) && !spacing.insert(feature.last().left);
  });
}

void FeatureSet::detect(const DetectionImage& left, SpacingGrid& spacing) {
  std::vector<Eigen::Vector2d> alive;
  for (const Feature& feature : features_)
    if (isSeen(feature)) alive.push_back(feature.last().left);
  for (const Corner& corner : detector_.detect(left, alive, spacing)) {
    Feature feature;
    FeatureObservation observation;
    observation.frame = frame_;
    observation.left = Eigen::Vector2d(corner.x, corner.y);
    feature.observe(observation);
    features_.push_back(feature);
  }
}

void FeatureSet::matchStereo(const ImagePyramid& left, const ImagePyramid& right) {
  forEachIndex(features_.size(), [&](std::size_t i) {
    Feature& feature = features_[i];
    if (!isSeen(feature)) return;
    FeatureObservation& observation = feature.last();
    const auto match = cartvo::vo::matchStereo(left, right, observation.left, settings_.stereo);
    if (!match || !right.mask.allows(match->right, 0)) return;
    observation.disparity = match->disparity;
  });
}

void FeatureSet::triangulate() {
  for (Feature& feature : features_)
    if (isSeen(feature) && feature.last().matched())
      feature.last().point =
          cartvo::vo::triangulate(camera_, {feature.last().left, feature.last().disparity});
}

void FeatureSet::removeLowWeights() {
  std::erase_if(features_,
                [&](const Feature& feature) { return feature.weight < settings_.history.minimum_weight; });
}

}  // namespace cartvo::vo
