#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tools/evaluate/validity/judged_messages.hpp"
#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// A published message compared with the truth. Twists: velocity of the body's origin (m/s) and rates (rad/s)
/// in body axes.
struct ComparedMessage {
  std::int64_t time_ns = 0;
  bool valid = false;
  std::int32_t reasons = 0;
  vo::Vector6d twist, twist_stddev;  ///< NaN if not valid
  vo::Vector6d true_twist;           ///< NaN where the truth is unknown
  /// Normalised errors squared over their dimension (e' P^-1 e / 6), of the twist and of the pose since the
  /// start of its epoch; empty where the truth is unknown, the message is not valid, or its covariance is not
  /// usable. A standstill whose twist is exactly zero has none of the twist.
  std::optional<double> twist_nees, pose_nees;
  JudgedMessage judged;
};

/// Compares messages with the true poses of the body, see trueStates. The truth must be sorted by time and
/// not be empty.
std::vector<ComparedMessage> compareMotion(const std::vector<OdometryRow>& rows, const Trajectory& truth);

/// The part that ValidityFigures count.
std::vector<JudgedMessage> judgedMessages(const std::vector<ComparedMessage>& messages);

}  // namespace cartvo
