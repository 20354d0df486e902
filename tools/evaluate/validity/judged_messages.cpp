// Errors of published messages, component by component.
#include "tools/evaluate/validity/judged_messages.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include "tools/evaluate/association.hpp"
#include "tools/evaluate/validity/true_twist.hpp"

namespace cartvo {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Magnitudes, infinite where the estimate has no number.
Eigen::Vector3d magnitudes(const Eigen::Vector3d& error) {
  return error.unaryExpr([](double value) {
    return std::isfinite(value) ? std::abs(value) : std::numeric_limits<double>::infinity();
  });
}

/// Finds for each VALID message the one from which its motion counts.
class MotionReference {
 public:
  explicit MotionReference(const std::vector<OdometryRow>& rows) : rows_(rows) {}

  /// For rows in their order. Empty for the first VALID message of an epoch, and behind a longer gap.
  std::optional<std::size_t> of(std::size_t index) {
    constexpr std::int64_t kTolerance_ns = 1'000'000;  // a frame period divides a second up to a rounding
    while (oldest_ < index && !isReference(oldest_, index, kMotionSpan_ns + kTolerance_ns))
      ++oldest_;
    return oldest_ < index ? std::optional(oldest_) : std::nullopt;
  }

 private:
  bool isReference(std::size_t earlier, std::size_t index, std::int64_t span_ns) const {
    const OdometryRow &row = rows_[earlier], &now = rows_[index];
    return row.valid && row.reset_counter == now.reset_counter && now.time_ns - row.time_ns <= span_ns;
  }

  const std::vector<OdometryRow>& rows_;
  std::size_t oldest_ = 0;
};

}  // namespace

std::vector<TrueState> trueStates(const std::vector<OdometryRow>& rows, const Trajectory& truth) {
  const InterpolatedTruth poses(truth);
  const TrueTwist twists(truth);
  std::vector<TrueState> states;
  for (const OdometryRow& row : rows) {
    TrueState& state = states.emplace_back();
    if (const auto stamped = poses.at(row.time_ns)) state.T_world_body = stamped->pose;
    state.twist = twists.at(row.time_ns);
  }
  return states;
}

std::vector<JudgedMessage> judge(const std::vector<OdometryRow>& rows, const std::vector<TrueState>& truth) {
  const Eigen::Vector3d unknown = Eigen::Vector3d::Constant(kNaN);
  MotionReference reference(rows);
  std::vector<JudgedMessage> judged;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const OdometryRow& row = rows[i];
    JudgedMessage& message = judged.emplace_back();
    message = {row.time_ns, row.valid, {unknown, unknown, unknown, unknown}, row.bound};
    if (!row.valid) continue;
    if (truth[i].twist) {
      const vo::Vector6d error = row.twist - *truth[i].twist;
      message.error.velocity = magnitudes(error.head<3>());
      message.error.angular_rate = magnitudes(error.tail<3>());
    }
    const std::optional<std::size_t> from = reference.of(i);
    if (!from || !truth[i].T_world_body || !truth[*from].T_world_body) continue;
    const Eigen::Isometry3d estimated = rows[*from].T_world_body.inverse() * row.T_world_body;
    const Eigen::Isometry3d exact = truth[*from].T_world_body->inverse() * *truth[i].T_world_body;
    const vo::Vector6d error = vo::vectorFromMotion(estimated.inverse() * exact);
    message.error.motion = magnitudes(error.head<3>());
    message.error.rotation = magnitudes(error.tail<3>());
  }
  return judged;
}

}  // namespace cartvo
