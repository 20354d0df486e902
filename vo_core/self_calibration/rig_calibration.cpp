#include "vo_core/self_calibration/rig_calibration.hpp"

#include <algorithm>
#include <cmath>

namespace cartvo::vo {
namespace {

double square(double value) {
  return value * value;
}

}  // namespace

RigCalibration::RigCalibration(const SelfCalibrationSettings& settings) : settings_(settings) {
  const EstimateWithStddev unknown{0.0, settings.calibration_stddev};
  states_ = {unknown, unknown, unknown, {0.0, settings.delay_stddev}};
}

void RigCalibration::set(const RigStates& states) {
  const EstimateWithStddev yaw = states_.yaw;
  states_ = states;
  // A short way shows no yaw: the estimate wanders, and the search for matches would follow it.
  if (!(states.yaw.stddev < settings_.yaw_pattern_stddev)) states_.yaw = yaw;
}

void RigCalibration::reinitialisePitch(const EstimateWithStddev& pitch) {
  states_.pitch = pitch;
  states_.roll.stddev = std::hypot(states_.roll.stddev, settings_.calibration_stddev);
  openYaw();
}

void RigCalibration::openYaw() {
  states_.yaw.stddev = std::hypot(states_.yaw.stddev, settings_.calibration_stddev);
  yaw_is_open_ = true;
}

double RigCalibration::priorYawStddev() const {
  return yaw_is_open_ ? states_.yaw.stddev : std::min(states_.yaw.stddev, settings_.yaw_pattern_stddev);
}

RigCorrection RigCalibration::limited(RigCorrection correction) const {
  for (double* const angle : {&correction.yaw, &correction.pitch, &correction.roll})
    *angle = std::clamp(*angle, -settings_.maximum_rotation, settings_.maximum_rotation);
  return correction;
}

RigCorrection RigCalibration::expected() const {
  return limited({.yaw = states_.yaw.value, .pitch = states_.pitch.value, .roll = states_.roll.value});
}

RigCorrection RigCalibration::correction() const {
  const auto significant = [](const EstimateWithStddev& state) {
    return shrunk(state.value, square(state.stddev));
  };
  return limited({.yaw = significant(states_.yaw),
                  .pitch = significant(states_.pitch),
                  .roll = significant(states_.roll)});
}

RigCalibrationError RigCalibration::error() const {
  RigCalibrationError error{states_.pitch, states_.yaw, states_.roll, states_.delay};
  const double uncorrected = states_.yaw.value - limited({.yaw = states_.yaw.value}).yaw;
  error.yaw.stddev = std::sqrt(square(states_.yaw.stddev) + square(settings_.yaw_pattern_stddev) +
                               square(settings_.uncorrected_yaw_share * uncorrected));
  const auto observability = [](const EstimateWithStddev& state, double prior_stddev) {
    return std::clamp(1.0 - square(state.stddev / prior_stddev), 0.0, 1.0);
  };
  const double rotation = settings_.calibration_stddev;
  error.observability = {observability(error.pitch, rotation), observability(error.yaw, rotation),
                         observability(error.roll, rotation),
                         observability(error.delay, settings_.delay_stddev)};
  return error;
}

}  // namespace cartvo::vo
