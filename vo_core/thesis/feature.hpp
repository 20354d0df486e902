#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "vo_core/odometry_settings.hpp"
#include "vo_core/stereo_camera.hpp"

// Tracked feature of `estimator: thesis`, with its last observations.

namespace cartvo::vo {

/// Number of observations that a feature keeps.
constexpr int kHistoryLength = kMaximumRefinementFrames;
static_assert(kMaximumSearchAgain < kHistoryLength, "the history covers the pairs of a search");

/// Observation of a feature by one pair.
struct FeatureObservation {
  std::int64_t frame = -1;                          ///< index of the pair; -1: none
  Eigen::Vector2d left = Eigen::Vector2d::Zero();   ///< px
  double disparity = 0.0;                           ///< px; 0: no match in the right image
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< m, in the left camera of that pair; if matched

  bool matched() const { return disparity > 0.0; }
};

/// A corner of the world that is tracked through the left images.
class Feature {
 public:
  /// Number of pairs that observed it.
  int age() const { return age_; }

  /// Weight from feature history, in [0, 1]: how likely it is part of the static world.
  double weight = 1.0;

  /// Observations, newest first; `back` < kHistoryLength. FeatureObservation::frame is -1 where there is
  /// none.
  const FeatureObservation& observation(int back) const { return history_[back]; }
  const FeatureObservation& last() const { return history_[0]; }
  FeatureObservation& last() { return history_[0]; }

  /// Its observation by pair `frame`, or nullptr.
  const FeatureObservation* at(std::int64_t frame) const {
    for (const FeatureObservation& observation : history_)
      if (observation.frame == frame) return &observation;
    return nullptr;
  }

  void observe(const FeatureObservation& observation) {
    std::shift_right(history_.begin(), history_.end(), 1);
    history_[0] = observation;
    ++age_;
  }

 private:
  int age_ = 0;
  std::array<FeatureObservation, kHistoryLength> history_{};
};

}  // namespace cartvo::vo
