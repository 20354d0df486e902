// Landmarks of a track's window: which take part, with which observations, and their depths.
#include <algorithm>

#include "vo_core/geometry/reprojection.hpp"
#include "vo_core/window/track_window.hpp"

namespace cartvo::vo {
namespace {

/// Positions of a landmark as observations. The anchor's patch is as noisy as the same patch later.
void toObservations(const Landmark& landmark, const RowTiming& timing,
                    const FixedVector<WindowPair, kMaximumWindowPairs>& pairs, WindowLandmark& item) {
  item.observations.clear();
  for (std::size_t i = 0; i < landmark.observations.size(); ++i) {
    const Observation& seen = landmark.observations[i];
    if (seen.outlier) continue;
    const auto* const pair = std::find_if(pairs.begin(), pairs.end(), [&](const WindowPair& candidate) {
      return candidate.index == seen.frame;
    });
    if (pair == pairs.end()) continue;
    WindowObservation& observation = item.observations.emplace_back();
    observation.pair = static_cast<int>(pair - pairs.begin());
    observation.stereo = seen.stereo;
    observation.left = seen.left;
    observation.right = seen.right();
    observation.left_share = timing.leftShare(observation.left);
    observation.right_share = timing.rightShare(observation.right);
    observation.relative_noise = landmark.observations[i == 0 ? 1 : i].relative_noise;
  }
}

/// The pair with this index, or nullptr.
const WindowPair* findPair(const WindowProblem& problem, std::int64_t index) {
  const auto* const found = std::find_if(problem.pairs.begin(), problem.pairs.end(),
                                         [&](const WindowPair& pair) { return pair.index == index; });
  return found == problem.pairs.end() ? nullptr : found;
}

/// Inverse depth (1/m) of a landmark by its left positions, which are linear in it: least squares with a weak
/// prior.
double depthByMotion(const WindowProblem& problem, const WindowLandmark& landmark) {
  constexpr double kUsual = 0.03;  // 1/m
  constexpr double kNoise = 2e-4;  // m, of a position in focal lengths over the stddev of the prior
  double numerator = kUsual * kNoise * kNoise, denominator = kNoise * kNoise;
  for (const WindowObservation& seen : landmark.observations) {
    const auto camera = problem.trajectory.at(problem.leftTime(seen.pair, seen.left_share));
    const Eigen::Matrix3d to_camera = camera.rotation.transpose();
    const Eigen::Vector3d far = to_camera * (landmark.T_world_host.linear() *
                                             Eigen::Vector3d(landmark.place.x(), landmark.place.y(), 1.0));
    const Eigen::Vector3d by_depth = to_camera * (landmark.T_world_host.translation() - camera.position);
    const Eigen::Vector3d bearing = bearingOf(problem.camera, seen.left);
    const Eigen::Vector2d slope = by_depth.head<2>() - by_depth.z() * bearing.head<2>();
    numerator += slope.dot(far.z() * bearing.head<2>() - far.head<2>());
    denominator += slope.squaredNorm();
  }
  return std::max(0.0, numerator / denominator);
}

}  // namespace

/// Lists the landmarks of the newest pair that take part, by key.
void TrackWindow::choose(const TrackWindowInput& input) {
  chosen_.clear();
  for (std::size_t i = 0; i < input.landmarks.size(); ++i) {
    const Landmark& landmark = input.landmarks[i];
    if (landmark.observations.size() < 2) continue;
    if (input.still_regions.contains(landmark.last().left)) continue;
    const Eigen::Vector2d& at = landmark.anchor().left;
    chosen_.emplace_back(Key{landmark.anchor().frame, at.x(), at.y()}, i);
  }
  std::sort(chosen_.begin(), chosen_.end());
}

/// Sets the landmarks of the newest pair with all their observations, at the places known so far.
void TrackWindow::addLandmarks(const TrackWindowInput& input) {
  WindowProblem& problem = next_.problem;
  std::vector<WindowLandmark> before;
  before.swap(problem.landmarks);
  std::vector<Key> keys;
  keys.swap(next_.keys);
  taking_part_.clear();
  problem.landmarks.reserve(chosen_.size());
  std::size_t at = 0;
  for (const auto& [key, index] : chosen_) {
    const Landmark& landmark = input.landmarks[index];
    const std::int64_t anchor = std::get<0>(key);
    while (at < keys.size() && keys[at] < key)
      ++at;
    WindowLandmark item;
    bool is_new = false;
    if (at < keys.size() && keys[at] == key) {
      item = before[at];
    } else {
      const Eigen::Vector2d& pixel = landmark.anchor().left;
      const WindowPair* const host = findPair(problem, anchor);
      if (host != nullptr) {
        const double time =
            problem.leftTime(static_cast<int>(host - problem.pairs.begin()), input.timing.leftShare(pixel));
        item.T_world_host = problem.trajectory.at(time).pose();
      } else {
        const WindowFrame* const frame = findFrame(input.window, anchor);
        if (frame == nullptr) continue;
        item.T_world_host = frame->T_world_camera;
      }
      const Eigen::Vector3d bearing =
          bearingOf(input.camera, host != nullptr ? pixel : landmark.anchor().leftAtExposure());
      item.place << bearing.x(), bearing.y(), landmark.inverse_depth;
      item.level = landmark.level;
      is_new = true;
    }
    toObservations(landmark, input.timing, problem.pairs, item);
    if (item.observations.size() < 2) continue;
    if (is_new && !landmark.hasDepth()) item.place.z() = depthByMotion(problem, item);
    next_.keys.push_back(key);
    taking_part_.push_back(index);
    problem.landmarks.push_back(item);
  }
}

/// Lists the landmarks with their depths. `pairs`: those of the window.
void TrackWindow::listAdjusted(const Pairs& pairs) {
  adjusted_.clear();
  for (std::size_t i = 0; i < taking_part_.size(); ++i) {
    const WindowLandmark& landmark = next_.problem.landmarks[i];
    AdjustedLandmark& adjusted = adjusted_.emplace_back();
    adjusted.index = taking_part_[i];
    adjusted.fit = solver_.fit(i);
    Eigen::Isometry3d T_anchor_host = Eigen::Isometry3d::Identity();  // of an anchor before a standstill
    if (const auto* const pair = findPair(next_.problem, std::get<0>(next_.keys[i]))) {
      const Pair& anchor = pairs[static_cast<std::size_t>(pair - next_.problem.pairs.begin())];
      T_anchor_host = anchor.T_world_camera.inverse() * landmark.T_world_host;
    }
    const double depth =  // times the inverse depth
        T_anchor_host.linear().row(2).dot(Eigen::Vector3d(landmark.place.x(), landmark.place.y(), 1.0)) +
        landmark.place.z() * T_anchor_host.translation().z();
    if (depth > kNearestRay)
      adjusted.inverse_depth = landmark.place.z() / depth;
    else
      adjusted.fit.information = 0.0;
  }
}

}  // namespace cartvo::vo
