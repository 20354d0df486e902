#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/protection_level.hpp"
#include "tools/evaluate/odometry_file.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// The truth of the body at the instant of a message; empty where it is unknown.
struct TrueState {
  std::optional<Eigen::Isometry3d> T_world_body;
  std::optional<vo::Vector6d> twist;  ///< velocity (m/s) and rates (rad/s) in body axes
};

/// A message and its errors.
struct JudgedMessage {
  std::int64_t time_ns = 0;
  bool valid = false;
  /// Magnitude of each component's error, in body axes; NaN where the truth is unknown or the message is not
  /// valid, infinite where a VALID message has no number. Motion and rotation: of the motion since the oldest
  /// VALID message of the same epoch in the last second (kMotionSpan_ns), because those are the poses that a
  /// controller may compare; NaN for the first one.
  pipeline::ProtectionLevel error;
  pipeline::ProtectionLevel bound;  ///< as the message states it; NaN where it states none
};

inline constexpr std::int64_t kMotionSpan_ns = 1'000'000'000;

/// The true state at each message, from true poses of the body alone, see TrueTwist and InterpolatedTruth.
/// `truth` must be sorted by time and not be empty.
std::vector<TrueState> trueStates(const std::vector<OdometryRow>& rows, const Trajectory& truth);

/// Judges messages, which are in the order of time; one truth for each.
std::vector<JudgedMessage> judge(const std::vector<OdometryRow>& rows, const std::vector<TrueState>& truth);

}  // namespace cartvo
