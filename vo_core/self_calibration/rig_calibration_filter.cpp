// Combines the filters of columns (yaw, p2), rows (pitch, roll) and delay.
#include "vo_core/self_calibration/rig_calibration_filter.hpp"

#include <cmath>

namespace cartvo::vo {
namespace {

constexpr double kMinimumWindowPath = 0.5;  // m driven within the window; less does not determine the yaw
// Added to the yaw's standard deviation: a constant (rad), and a factor of the yaw beyond the limit of the
// correction (rad per rad): depths are then so wrong that the linearised equations show a fifth of the yaw.
// Both determined on rendered worlds.
constexpr double kMinimumYawStddev = 2e-4;
constexpr double kUncorrectedYawFactor = 4.0;

}  // namespace

void RigCalibrationFilter::update(const BundleProblem& adjusted, const BundleResult& result,
                                  const RowMeasurement& rows, const RigCorrection& applied,
                                  double time_step) {
  const Eigen::Isometry3d path =
      adjusted.poses.front().T_world_camera.inverse() * adjusted.poses.back().T_world_camera;
  if (path.translation().norm() > kMinimumWindowPath)
    columns_.update(result.rig_information, result.rig_gradient, applied, time_step);
  rows_.update(rows, applied, time_step);
  delay_.update(rows, applied, time_step);
  if (const double step = rows_.takeYawStep(); step != 0.0) {
    columns_.applyYawStep(step);
    delay_.restart(0.0);
  }
}

void RigCalibrationFilter::reinitialisePitch(const BundleProblem& matches) {
  const double before = rows_.estimate()[RowErrors::kPitch];
  rows_.reinitialisePitch(measureRows(matches));
  if (const double step = rows_.estimate()[RowErrors::kPitch] - before; step != 0.0) delay_.restart(step);
}

RigCorrection RigCalibrationFilter::correction() const {
  RigCorrection correction = columns_.correction();
  const RigCorrection by_rows = rows_.correction();
  correction.pitch = by_rows.pitch;
  correction.roll = by_rows.roll;
  return correction;
}

RigCorrection RigCalibrationFilter::expected() const {
  RigCorrection expected = rows_.expected();
  expected.yaw = columns_.correction().yaw;
  return expected;
}

RigCalibrationError RigCalibrationFilter::error() const {
  const RowErrors::Vector& rows = rows_.estimate();
  const RowErrors::Vector row_stddev = rows_.stddev();
  const auto of_rows = [&](RowErrors::Index index) {
    return EstimateWithStddev{rows[index], row_stddev[index]};
  };
  const double yaw = columns_.estimate()[0];
  const double yaw_stddev = std::sqrt(std::pow(columns_.stddev()[0], 2) + std::pow(kMinimumYawStddev, 2) +
                                      std::pow(kUncorrectedYawFactor * (yaw - columns_.correction().yaw), 2));
  return {of_rows(RowErrors::kPitch), {yaw, yaw_stddev}, of_rows(RowErrors::kRoll), delay_.delay()};
}

}  // namespace cartvo::vo
