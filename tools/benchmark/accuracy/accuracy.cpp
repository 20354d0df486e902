// Compares a replay with the ground truth pair by pair, and summarises several sequences.
#include "tools/benchmark/accuracy/accuracy.hpp"

#include <algorithm>
#include <cmath>

#include "tools/benchmark/accuracy/judged_replay.hpp"
#include "tools/benchmark/accuracy/true_motion.hpp"
#include "tools/evaluate/association.hpp"

namespace cartvo::benchmark {
namespace {

// A true motion between two pairs below both limits counts as standstill.
constexpr double kStandingTranslation = 1e-4;  // m
constexpr double kStandingRotation = 1e-4;     // rad

double angleOf(const Eigen::Isometry3d& motion) {
  return vo::vectorFromMotion(motion).tail<3>().norm();
}

/// Accumulates the errors and counts of all pairs of a replay.
class AccuracyMeasurement {
 public:
  AccuracyMeasurement(const Replay& replay, const SequenceTruth& truth)
      : replay_(replay), truth_(truth), rows_(replay, truth.left_camera) {}

  SequenceAccuracy measure() {
    for (std::size_t index = 0; index < replay_.pairs.size(); ++index)
      addPair(index);
    return std::move(result_);
  }

 private:
  void addPair(std::size_t index) {
    const ReplayedPair& pair = replay_.pairs[index];
    if (index > 0) result_.times_ms.push_back(1e3 * pair.times.total);
    if (!pair.valid && index > 0) ++result_.invalid;
    if (index == 0 || !(pair.time_step > 0.0)) return;  // no motion was measured
    const auto from = rows_.at(referenceOf(replay_, index)), to = rows_.at(index);
    if (!epoch_begun_ || pair.reset_counter != epoch_) {
      epoch_begun_ = true;
      epoch_ = pair.reset_counter;
      epoch_start_ = from;
      result_.consistency.pose.beginGroup();
    }
    if (!to || !pair.valid) return;
    if (from) addMotion(pair, *from, *to);
    if (epoch_start_) {
      result_.consistency.pose.add(
          vo::vectorFromMotion(pair.T_epoch_left.inverse() * trueMotion(*epoch_start_, *to)),
          pair.pose_covariance);
    }
  }

  void addMotion(const ReplayedPair& pair, std::size_t from, std::size_t to) {
    const Eigen::Isometry3d motion = trueMotion(from, to);
    const vo::Vector6d error = vo::vectorFromMotion(pair.T_previous_current.inverse() * motion);
    if (motion.translation().norm() < kStandingTranslation && angleOf(motion) < kStandingRotation) {
      ++result_.standing;
      result_.standing_speed = std::max(result_.standing_speed, pair.velocity.norm());
    }
    constexpr double kMaxStandstillMotion = 1e-3;  // m
    // A zero-velocity update reports exactly the identity.
    const bool is_zero_velocity_update = pair.T_previous_current.matrix().isIdentity(1e-12);  // rounding
    if (is_zero_velocity_update && motion.translation().norm() < kMaxStandstillMotion) return;
    result_.consistency.motion.beginGroup();
    result_.consistency.motion.add(error, pair.motion_covariance);
    if (truth_.body_twist.empty()) return;
    vo::Vector6d twist;
    twist << pair.velocity, pair.angular_velocity;
    result_.consistency.velocity.beginGroup();
    result_.consistency.velocity.add(twist - truth_.body_twist[to], pair.twist_covariance);
  }

  Eigen::Isometry3d trueMotion(std::size_t from, std::size_t to) const {
    return truth_.left_camera[from].pose.inverse() * truth_.left_camera[to].pose;
  }

  const Replay& replay_;
  const SequenceTruth& truth_;
  const TruthRows rows_;
  SequenceAccuracy result_;
  bool epoch_begun_ = false;
  std::uint32_t epoch_ = 0;
  std::optional<std::size_t> epoch_start_;  ///< index into truth_.left_camera
};

void addSegments(SegmentErrors& sum, const SegmentErrors& errors) {
  sum.count += errors.count;
  sum.translation += errors.translation * errors.count;
  sum.rotation += errors.rotation * errors.count;
}

void divide(SegmentErrors& sum) {
  if (sum.count == 0) return;
  sum.translation /= sum.count;
  sum.rotation /= sum.count;
}

/// Combines the evaluations of several sequences into one, see `summarise`.
class EvaluationMean {
 public:
  void add(const Evaluation& one) {
    sum_.poses += one.poses;
    sum_.unmatched += one.unmatched;
    sum_.path_length += one.path_length;
    sum_.estimated_path_length += one.estimated_path_length;
    addSegments(sum_.short_segments.all, one.short_segments.all);
    addSegments(sum_.long_segments.all, one.long_segments.all);
    const auto motions = static_cast<double>(one.poses - 1);
    motions_ += motions;
    sum_.relative_translation += motions * one.relative_translation * one.relative_translation;
    sum_.relative_rotation += motions * one.relative_rotation * one.relative_rotation;
    if (!one.final_drift_fraction) return;
    ++moving_;
    sum_.final_drift += one.final_drift;
    sum_.final_drift_fraction = sum_.final_drift_fraction.value_or(0.0) + *one.final_drift_fraction;
  }

  Evaluation mean() const {
    Evaluation mean = sum_;
    divide(mean.short_segments.all);
    divide(mean.long_segments.all);
    mean.relative_translation = std::sqrt(mean.relative_translation / motions_);
    mean.relative_rotation = std::sqrt(mean.relative_rotation / motions_);
    if (moving_ > 0) {
      mean.final_drift /= moving_;
      *mean.final_drift_fraction /= moving_;
    }
    return mean;
  }

 private:
  Evaluation sum_;
  double motions_ = 0.0;
  int moving_ = 0;
};

}  // namespace

void Consistency::add(const Consistency& other) {
  motion.add(other.motion);
  pose.add(other.pose);
  velocity.add(other.velocity);
}

SequenceAccuracy measureAccuracy(const Replay& replay, const SequenceTruth& truth,
                                 const pipeline::AlertLimits& limits) {
  SequenceAccuracy accuracy = AccuracyMeasurement(replay, truth).measure();
  accuracy.pairs = replay.pairs.size();
  accuracy.lost = truth.left_camera.size() - std::min(truth.left_camera.size(), accuracy.pairs);
  accuracy.resets = replay.pairs.back().reset_counter;
  accuracy.validity = validityFigures(judge(replay, truth), limits);
  accuracy.evaluation = evaluate(associateByTime(leftCameraTrajectory(replay), truth.left_camera));
  if (!accuracy.evaluation.final_drift_fraction) {
    accuracy.standing_end = {accuracy.evaluation.final_drift, accuracy.evaluation.final_rotation};
  }
  return accuracy;
}

SequenceAccuracy summarise(const std::string& name, const std::vector<SequenceAccuracy>& accuracies) {
  SequenceAccuracy all;
  all.sequence = name;
  all.kind = accuracies.front().kind;
  all.set = accuracies.front().set;
  all.bitrate_mbps = accuracies.front().bitrate_mbps;
  all.estimator = accuracies.front().estimator;
  EvaluationMean evaluation;
  for (const SequenceAccuracy& one : accuracies) {
    all.pairs += one.pairs;
    all.lost += one.lost;
    all.invalid += one.invalid;
    all.resets += one.resets;
    all.validity.add(one.validity);
    all.standing += one.standing;
    all.standing_speed = std::max(all.standing_speed, one.standing_speed);
    all.consistency.add(one.consistency);
    all.times_ms.insert(all.times_ms.end(), one.times_ms.begin(), one.times_ms.end());
    evaluation.add(one.evaluation);
    if (!one.standing_end) continue;
    const EndError before = all.standing_end.value_or(EndError{});
    all.standing_end = {std::max(before.translation, one.standing_end->translation),
                        std::max(before.rotation, one.standing_end->rotation)};
  }
  all.evaluation = evaluation.mean();
  return all;
}

}  // namespace cartvo::benchmark
