// Compares the covariances and velocities of a replay with the truth, pair by pair.
#include "tools/replay/truth_consistency.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/units.hpp"

namespace cartvo {
namespace {

using Json = nlohmann::ordered_json;

// A true motion between two pairs below both limits counts as standstill.
constexpr double kStandingTranslation = 1e-4;  // m
constexpr double kStandingRotation = 1e-4;     // rad

/// Index of the pair from which the motion of a pair is measured, which is one of those before.
std::size_t referenceOf(const Replay& replay, std::size_t index) {
  const ReplayedPair& pair = replay.pairs[index];
  const auto distance = [&](std::size_t from) {
    const double step = 1e-9 * static_cast<double>(pair.exposure_ns - replay.pairs[from].exposure_ns);
    return std::abs(step - pair.time_step);
  };
  std::size_t reference = index - 1;
  while (reference > 0 && distance(reference - 1) < distance(reference))
    --reference;
  return reference;
}

/// Accumulates the errors of all pairs of a replay.
class ConsistencyMeasurement {
 public:
  ConsistencyMeasurement(const Replay& replay, const Truth& truth, const TrueTwist& twist)
      : replay_(replay), twist_(twist) {
    const Eigen::Isometry3d& T_body_left = replay.rig.rig.T_body_camera;
    for (const std::optional<Eigen::Isometry3d>& body : truth) {
      left_camera_.emplace_back();
      if (body) left_camera_.back() = T_body_left.inverse() * *body * T_body_left;
    }
  }

  TruthConsistency measure() {
    for (std::size_t index = 1; index < replay_.pairs.size(); ++index)
      addPair(index);
    if (rates_ > 0) {
      result_.rate_error = std::sqrt(result_.rate_error / static_cast<double>(rates_));
      result_.true_rate = std::sqrt(result_.true_rate / static_cast<double>(rates_));
    }
    return std::move(result_);
  }

 private:
  using Pose = std::optional<Eigen::Isometry3d>;

  void addPair(std::size_t index) {
    const ReplayedPair& pair = replay_.pairs[index];
    if (!(pair.time_step > 0.0)) return;  // no motion was measured
    const Pose &from = left_camera_[referenceOf(replay_, index)], &to = left_camera_[index];
    if (!epoch_ || pair.reset_counter != *epoch_) {
      epoch_ = pair.reset_counter;
      epoch_start_ = from;
      result_.pose.beginGroup();
    }
    if (!to || !pair.valid) return;
    if (from) addMotion(pair, from->inverse() * *to);
    if (epoch_start_) {
      result_.pose.add(vo::vectorFromMotion(pair.T_epoch_left.inverse() * epoch_start_->inverse() * *to),
                       pair.pose_covariance);
    }
  }

  void addMotion(const ReplayedPair& pair, const Eigen::Isometry3d& motion) {
    const vo::Vector6d moved = vo::vectorFromMotion(motion);
    if (motion.translation().norm() < kStandingTranslation && moved.tail<3>().norm() < kStandingRotation) {
      ++result_.standing;
      result_.standing_speed = std::max(result_.standing_speed, pair.velocity.norm());
    }
    const std::optional<vo::Vector6d> true_twist = twist_.at(pair.exposure_ns);
    vo::Vector6d twist;
    twist << pair.velocity, pair.angular_velocity;
    if (true_twist && twist.allFinite()) {
      result_.rate_error += (twist - *true_twist).tail<3>().squaredNorm();
      result_.true_rate += true_twist->tail<3>().squaredNorm();
      ++rates_;
    }
    constexpr double kMaxStandstillMotion = 1e-3;  // m
    // A zero-velocity update reports exactly the identity.
    const bool is_zero_velocity_update = pair.T_previous_current.matrix().isIdentity(1e-12);  // rounding
    if (is_zero_velocity_update && motion.translation().norm() < kMaxStandstillMotion) return;
    result_.motion.beginGroup();
    result_.motion.add(vo::vectorFromMotion(pair.T_previous_current.inverse() * motion),
                       pair.motion_covariance);
    if (!true_twist) return;
    result_.velocity.beginGroup();
    result_.velocity.add(twist - *true_twist, pair.twist_covariance);
  }

  const Replay& replay_;
  const TrueTwist& twist_;
  std::vector<Pose> left_camera_;
  TruthConsistency result_;
  std::optional<std::uint32_t> epoch_;
  Pose epoch_start_;
  std::size_t rates_ = 0;
};

/// The true poses of the body, as densely as they are known.
Trajectory bodyPoses(const Replay& replay, const Truth& truth, const std::filesystem::path& file) {
  if (!std::filesystem::is_directory(file) && !isKittiTrajectory(file)) return readTruthRows(file);
  Trajectory poses;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const std::int64_t time_ns = replay.pairs[i].exposure_ns;
    if (truth[i] && (poses.empty() || time_ns > poses.back().time_ns)) poses.push_back({time_ns, *truth[i]});
  }
  return poses;
}

Json errorsJson(const NormalisedErrors& errors) {
  Json json{{"mean", nullptr},
            {"band_95_percent", nullptr},
            {"samples", errors.groups()},
            {"unusable", errors.unusable()}};
  if (errors.groups() == 0) return json;
  const Interval band = errors.band();
  json["mean"] = errors.mean();
  json["band_95_percent"] = {band.low, band.high};
  return json;
}

}  // namespace

TruthConsistency consistencyWithTruth(const Replay& replay, const Truth& truth, const TrueTwist& twist) {
  return ConsistencyMeasurement(replay, truth, twist).measure();
}

TruthConsistency consistencyWithTruth(const Replay& replay, const Truth& truth,
                                      const std::filesystem::path& file) {
  return consistencyWithTruth(replay, truth, TrueTwist(bodyPoses(replay, truth, file)));
}

Json consistencyJson(const TruthConsistency& consistency) {
  const bool stands = consistency.standing > 0, turns = consistency.true_rate > 0.0;
  return {{"nees_motion", errorsJson(consistency.motion)},
          {"nees_pose", errorsJson(consistency.pose)},
          {"nees_velocity", errorsJson(consistency.velocity)},
          {"standing_pairs", consistency.standing},
          {"standing_highest_speed_m_s", stands ? Json(consistency.standing_speed) : Json(nullptr)},
          {"rate_error_deg_s", turns ? Json(kDegreesPerRadian * consistency.rate_error) : Json(nullptr)},
          {"true_rate_deg_s", turns ? Json(kDegreesPerRadian * consistency.true_rate) : Json(nullptr)}};
}

}  // namespace cartvo
