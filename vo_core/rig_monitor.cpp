// Both monitors, as one.
#include "vo_core/rig_monitor.hpp"

#include <cmath>

namespace cartvo {
namespace {

constexpr double kTellingWay = 0.5;  // m driven within the window, for disparities to tell of the rig
// Standard deviation of a yaw, rad, and what is added to it for each rad by which it is beyond what may be
// corrected: depths are then so wrong that the equations, which are linear, show a fifth of the yaw. Both
// found on rendered worlds.
constexpr double kYawFloor = 2e-4;
constexpr double kBeyondBounds = 4.0;

}  // namespace

void RigMonitor::add(const BundleProblem& adjusted, const BundleResult& result, const RowEvidence& rows,
                     const RigCorrection& applied, double time_step) {
  const Eigen::Isometry3d way =
      adjusted.poses.front().T_world_camera.inverse() * adjusted.poses.back().T_world_camera;
  if (way.translation().norm() > kTellingWay)
    columns_.add(result.rig_information, result.rig_gradient, applied, time_step);
  rows_.add(rows, applied, time_step);
  if (const double turn = rows_.takeTurn(); turn != 0.0) columns_.turn(turn);
}

RigCorrection RigMonitor::correction() const {
  RigCorrection correction = columns_.correction();
  const RigCorrection by_rows = rows_.correction();
  correction.pitch = by_rows.pitch;
  correction.roll = by_rows.roll;
  return correction;
}

RigCorrection RigMonitor::expected() const {
  RigCorrection expected = rows_.expected();
  expected.yaw = columns_.correction().yaw;
  return expected;
}

RigCheck RigMonitor::check() const {
  const RowErrors::Vector& rows = rows_.estimate();
  const RowErrors::Vector row_deviations = rows_.deviation();
  const auto of_rows = [&](RowErrors::Index index) { return Checked{rows[index], row_deviations[index]}; };
  const double yaw = columns_.estimate()[0];
  const double yaw_deviation = std::sqrt(std::pow(columns_.deviation()[0], 2) + std::pow(kYawFloor, 2) +
                                         std::pow(kBeyondBounds * (yaw - columns_.correction().yaw), 2));
  return {of_rows(RowErrors::kPitch),
          {yaw, yaw_deviation},
          of_rows(RowErrors::kRoll),
          of_rows(RowErrors::kDelay)};
}

}  // namespace cartvo
