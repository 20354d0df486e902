// Online estimation of the pose errors of video coding.
#include "vo_core/integrity/codec_error_model.hpp"

#include <algorithm>
#include <cmath>

#include "vo_core/fixed_constants.hpp"

namespace cartvo::vo {
namespace {

using Axes = Eigen::Array<double, 6, 1>;

constexpr std::array<Eigen::Index, 2> kSmoothAxes{2, 4};  // forwards and yaw
constexpr double kMinimumVariance = 1e-14;                // m^2 and rad^2

}  // namespace

CodecErrorModel::BiasEstimate CodecErrorModel::initialBias() {
  return {Vector6d::Zero(),
          Vector6d::Constant(codec_errors::kInitialBiasStddev * codec_errors::kInitialBiasStddev)};
}

std::optional<PoseShift> CodecErrorModel::restart(KeyFrames pair) {
  const Vector6d sensitivity = history_.empty() ? Vector6d(Vector6d::Zero()) : history_.back().sensitivity;
  history_.clear();
  history_.push_back({pair});
  if (!pair.any()) return std::nullopt;
  const BiasEstimate& bias = biases_[classOf(pair)];
  const Vector6d square = bias.mean.cwiseAbs2() + bias.variance;
  return PoseShift{Vector6d::Zero(), sensitivity.cwiseAbs2().cwiseProduct(square)};
}

std::optional<PoseShift> CodecErrorModel::update(KeyFrames pair, const MeasuredMotion& measured) {
  const KeyFrames before = history_.back().key_frames;
  if (std::max(measured.time_step, time_step_) >
      codec_errors::kMaximumStepRatio * std::min(measured.time_step, time_step_))
    restart(before);
  time_step_ = measured.time_step;
  if (history_.size() == kPairs) {
    std::move(history_.begin() + 1, history_.end(), history_.begin());
    history_.resize(kPairs - 1);
  }
  const Vector6d sensitivity = std::copysign(1.0, measured.motion.z()) * measured.stddev;
  history_.push_back({pair, measured, sensitivity});
  if (history_.size() == kPairs) updateEstimates();
  if (!pair.any() || pair == before) return std::nullopt;
  const BiasEstimate& bias = biases_[classOf(pair)];
  return PoseShift{sensitivity.cwiseProduct(bias.mean), sensitivity.cwiseAbs2().cwiseProduct(bias.variance)};
}

/// Weights of the last poses whose weighted sum vanishes for a cubic in time: those of the fourth divided
/// difference, normalised to unit length so that the variance of the sum is that of a pose.
CodecErrorModel::Weights CodecErrorModel::weightsOffCubic() const {
  Weights instants{}, weights{};
  for (std::size_t i = 1; i < kPairs; ++i)
    instants[i] = instants[i - 1] + history_[i].measured.time_step;
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

void CodecErrorModel::updateEstimates() {
  const Weights off_cubic = weightsOffCubic();
  Vector6d innovation = Vector6d::Zero();
  Sensitivities sensitivities;
  sensitivities.fill(Vector6d::Zero());
  bool has_key_frame = false;
  // A pose is the sum of the motions up to it, so that the weight of a motion is the sum of those of its pose
  // and of all later ones.
  double weight = 0.0;
  for (std::size_t i = kPairs; i-- > 0;) {
    const History& entry = history_[i];
    weight += off_cubic[i];
    if (i > 0) innovation += weight * entry.measured.motion;
    if (i > 0 && entry.measured.noise_uncalibrated) return;
    if (!entry.key_frames.any()) continue;
    has_key_frame = true;
    sensitivities[classOf(entry.key_frames)] += off_cubic[i] * entry.sensitivity;
  }
  if (!has_key_frame) return updateRoughness(innovation);
  if (history_[kPairs / 2].key_frames.any() && rough_pairs_ >= codec_errors::kMinimumRoughPairs)
    updateBias(innovation, sensitivities);
}

void CodecErrorModel::updateRoughness(const Vector6d& innovation) {
  Axes square = innovation.array().square();
  if (rough_pairs_ >= codec_errors::kMinimumRoughPairs)
    square = square.min(codec_errors::kInnovationGate * codec_errors::kInnovationGate * roughness_.array());
  Vector6d predicted = Vector6d::Zero();
  for (std::size_t i = 1; i < kPairs; ++i)
    predicted += codec_errors::kPoseVariance / (kPairs - 1) * history_[i].measured.stddev.cwiseAbs2();
  rough_pairs_ = std::min(rough_pairs_ + 1, codec_errors::kRoughnessMemory);
  roughness_ += (square.matrix() - roughness_) / rough_pairs_;
  predicted_roughness_ += (predicted - predicted_roughness_) / rough_pairs_;
}

double CodecErrorModel::poseNoiseInflation() const {
  if (rough_pairs_ < codec_errors::kMinimumRoughPairs) return 1.0;
  double sum = 0.0;
  for (const Eigen::Index axis : kSmoothAxes)
    sum += roughness_[axis] / (predicted_roughness_[axis] + kMinimumVariance);
  return std::clamp(sum / kSmoothAxes.size(), 1.0, codec_errors::kMaximumInflation);
}

/// `sensitivities`: d(innovation)/d(b) for each class.
void CodecErrorModel::updateBias(const Vector6d& innovation, const Sensitivities& sensitivities) {
  const std::size_t middle = classOf(history_[kPairs / 2].key_frames);
  Axes residual = innovation.array();
  Axes noise = roughness_.array() + kMinimumVariance;
  for (std::size_t i = 0; i < kClasses; ++i) {
    residual -= (sensitivities[i].cwiseProduct(biases_[i].mean)).array();
    if (i != middle) noise += sensitivities[i].array().square() * biases_[i].variance.array();
  }
  BiasEstimate& bias = biases_[middle];
  const Axes sensitivity = sensitivities[middle].array();
  const Axes by_shift = sensitivity.square() * bias.variance.array();
  const Axes limit = codec_errors::kInnovationGate * (by_shift + noise).sqrt();
  residual = residual.min(limit).max(-limit);
  // Share of the innovation that the shift causes. No division by the sensitivity, which may be zero.
  const Axes share = by_shift / (by_shift + noise);
  const Axes by_innovation = (1.0 - codec_errors::kBiasMemory) * bias.variance.array() / (by_shift + noise);
  bias.mean += (by_innovation * sensitivity * residual).matrix();
  bias.variance += (by_innovation * (residual.square() - noise) -
                    (1.0 - codec_errors::kBiasMemory) * share * bias.variance.array())
                       .matrix();
  bias.variance = bias.variance.cwiseMax(codec_errors::kMinimumBiasStddev * codec_errors::kMinimumBiasStddev);
}

}  // namespace cartvo::vo
