#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "vo_core/stereo_camera.hpp"

namespace cartvo {

constexpr int kHistoryLength = 8;       ///< observations a feature keeps; bounds refinement.frames
constexpr int kMaximumSearchAgain = 7;  ///< bounds tracking.search_again, so that the history covers it

/// A feature seen by one pair.
struct Observation {
  std::int64_t frame = -1;                          ///< index of the pair; -1: none
  Eigen::Vector2d left = Eigen::Vector2d::Zero();   ///< px
  double disparity = 0.0;                           ///< px; 0: no match in the right image
  double right_row = 0.0;                           ///< px, row of the match in the right image
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< m, in the left camera at that pair; if matched

  bool matched() const { return disparity > 0.0; }
};

/// A corner of the world followed through the left images.
class Feature {
 public:
  Feature(std::uint64_t id, float score) : id_(id), score_(score) {}

  std::uint64_t id() const { return id_; }
  /// FAST score (thesis 4.9) when it was detected.
  float score() const { return score_; }
  /// Pairs that saw it.
  int age() const { return age_; }

  /// From feature history, in [0, 1]: how much it is believed to belong to the static world.
  double weight = 1.0;

  /// Newest first; `back` < kHistoryLength; Observation::frame is -1 where there is none.
  const Observation& seen(int back) const { return history_[back]; }
  const Observation& last() const { return history_[0]; }
  Observation& last() { return history_[0]; }

  /// Its observation by pair `frame`, or nullptr.
  const Observation* at(std::int64_t frame) const {
    for (const Observation& observation : history_)
      if (observation.frame == frame) return &observation;
    return nullptr;
  }

  void observe(const Observation& observation) {
    std::shift_right(history_.begin(), history_.end(), 1);
    history_[0] = observation;
    ++age_;
  }

 private:
  std::uint64_t id_;
  float score_;
  int age_ = 0;
  std::array<Observation, kHistoryLength> history_{};
};

}  // namespace cartvo
