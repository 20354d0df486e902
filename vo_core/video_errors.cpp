// What pictures of a video show elsewhere than it was, learned from how poses leap.
#include "vo_core/video_errors.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo {
namespace {

using Axes = Eigen::Array<double, 6, 1>;

// The variance of a pose for that of a motion, if poses err independently of each other: a motion has the
// errors of two.
constexpr double kPoseVariance = 0.5;
constexpr std::array<Eigen::Index, 2> kSmoothAxes{2, 4};  // forwards and yaw
constexpr double kFirstDeviations = 2.0;                  // of the shift, in standard deviations of a motion
constexpr double kLeastDeviations = 0.2;                  // that remain in doubt
constexpr double kMemory = 0.8;           // from key frame to key frame, if nothing were noise
constexpr int kRoughnessMemory = 20;      // pairs
constexpr int kRoughnessKnown = 5;        // pairs
constexpr double kMostDeviations = 3.0;   // by which a leap is believed
constexpr double kMostExcess = 30.0;      // beyond which poses are said to be off by something else
constexpr double kMostUneven = 3.5;       // times a time step, that the next may be longer or shorter
constexpr double kLeastVariance = 1e-14;  // m^2 and rad^2; no motion is known better

}  // namespace

VideoErrors::Learned VideoErrors::unknown() {
  return {Vector6d::Zero(), Vector6d::Constant(kFirstDeviations * kFirstDeviations)};
}

std::optional<PoseShift> VideoErrors::begin(KeyFrames pair) {
  const Vector6d lever = passed_.empty() ? Vector6d(Vector6d::Zero()) : passed_.back().lever;
  passed_.clear();
  passed_.push_back({pair});
  if (!pair.any()) return std::nullopt;
  const Learned& learned = learned_[classOf(pair)];
  const Vector6d square = learned.mean.cwiseAbs2() + learned.square;
  return PoseShift{Vector6d::Zero(), lever.cwiseAbs2().cwiseProduct(square)};
}

std::optional<PoseShift> VideoErrors::next(KeyFrames pair, const ShownMotion& shown) {
  const KeyFrames before = passed_.back().key_frames;
  if (std::max(shown.time_step, time_step_) > kMostUneven * std::min(shown.time_step, time_step_))
    begin(before);
  time_step_ = shown.time_step;
  if (passed_.size() == kPairs) {
    std::move(passed_.begin() + 1, passed_.end(), passed_.begin());
    passed_.resize(kPairs - 1);
  }
  const Vector6d lever = std::copysign(1.0, shown.motion.z()) * shown.deviation;
  passed_.push_back({pair, shown, lever});
  if (passed_.size() == kPairs) learn();
  if (!pair.any() || pair == before) return std::nullopt;
  const Learned& learned = learned_[classOf(pair)];
  return PoseShift{lever.cwiseProduct(learned.mean), lever.cwiseAbs2().cwiseProduct(learned.square)};
}

/// Weights of the last poses, whose sum with them is none if they lie on a cubic of their instants: those of
/// the fourth divided difference, made to be of unit length, so that the sum's variance is a pose's.
VideoErrors::Weights VideoErrors::weightsOffCubic() const {
  Weights instants{}, weights{};
  for (std::size_t i = 1; i < kPairs; ++i)
    instants[i] = instants[i - 1] + passed_[i].shown.time_step;
  double squares = 0.0;
  for (std::size_t i = 0; i < kPairs; ++i) {
    double product = 1.0;
    for (std::size_t j = 0; j < kPairs; ++j)
      if (j != i) product *= (instants[i] - instants[j]) / instants.back();
    weights[i] = 1.0 / product;
    squares += weights[i] * weights[i];
  }
  for (double& weight : weights)
    weight /= std::sqrt(squares);
  return weights;
}

void VideoErrors::learn() {
  const Weights off_cubic = weightsOffCubic();
  Vector6d leap = Vector6d::Zero();
  Levers levers;
  levers.fill(Vector6d::Zero());
  bool has_key_frame = false;
  // A pose is the sum of the motions to it, so that a motion has the weights of its own pose and all later
  // ones.
  double weight = 0.0;
  for (std::size_t i = kPairs; i-- > 0;) {
    const Passed& passed = passed_[i];
    weight += off_cubic[i];
    if (i > 0) leap += weight * passed.shown.motion;
    if (i > 0 && passed.shown.guessed) return;
    if (!passed.key_frames.any()) continue;
    has_key_frame = true;
    levers[classOf(passed.key_frames)] += off_cubic[i] * passed.lever;
  }
  if (!has_key_frame) return learnRoughness(leap);
  if (passed_[kPairs / 2].key_frames.any() && rough_pairs_ >= kRoughnessKnown) learnShift(leap, levers);
}

void VideoErrors::learnRoughness(const Vector6d& leap) {
  Axes square = leap.array().square();
  if (rough_pairs_ >= kRoughnessKnown)
    square = square.min(kMostDeviations * kMostDeviations * roughness_.array());
  Vector6d foretold = Vector6d::Zero();
  for (std::size_t i = 1; i < kPairs; ++i)
    foretold += kPoseVariance / (kPairs - 1) * passed_[i].shown.deviation.cwiseAbs2();
  rough_pairs_ = std::min(rough_pairs_ + 1, kRoughnessMemory);
  roughness_ += (square.matrix() - roughness_) / rough_pairs_;
  foretold_ += (foretold - foretold_) / rough_pairs_;
}

double VideoErrors::excess() const {
  if (rough_pairs_ < kRoughnessKnown) return 1.0;
  double sum = 0.0;
  for (const Eigen::Index axis : kSmoothAxes)
    sum += roughness_[axis] / (foretold_[axis] + kLeastVariance);
  return std::clamp(sum / kSmoothAxes.size(), 1.0, kMostExcess);
}

/// `levers`: by how much the leap grows with each class' b.
void VideoErrors::learnShift(const Vector6d& leap, const Levers& levers) {
  const std::size_t middle = classOf(passed_[kPairs / 2].key_frames);
  Axes unexplained = leap.array();
  Axes noise = roughness_.array() + kLeastVariance;
  for (std::size_t i = 0; i < kClasses; ++i) {
    unexplained -= (levers[i].cwiseProduct(learned_[i].mean)).array();
    if (i != middle) noise += levers[i].array().square() * learned_[i].square.array();
  }
  Learned& learned = learned_[middle];
  const Axes lever = levers[middle].array();
  const Axes by_shift = lever.square() * learned.square.array();
  const Axes most = kMostDeviations * (by_shift + noise).sqrt();
  unexplained = unexplained.min(most).max(-most);
  // The share of the leap that the shift makes; nothing is divided by a lever, which may be none.
  const Axes share = by_shift / (by_shift + noise);
  const Axes by_leap = (1.0 - kMemory) * learned.square.array() / (by_shift + noise);
  learned.mean += (by_leap * lever * unexplained).matrix();
  learned.square +=
      (by_leap * (unexplained.square() - noise) - (1.0 - kMemory) * share * learned.square.array()).matrix();
  learned.square = learned.square.cwiseMax(kLeastDeviations * kLeastDeviations);
}

}  // namespace cartvo
