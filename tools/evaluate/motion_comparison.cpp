// Compares published velocities, rates and covariances with the truth.
#include "tools/evaluate/motion_comparison.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstddef>
#include <limits>

namespace cartvo {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::optional<double> normalised(const vo::Vector6d& error, const vo::Matrix6d& covariance) {
  constexpr double kDimension = 6.0;
  const Eigen::LLT<vo::Matrix6d> factor(covariance);
  if (!covariance.allFinite() || !error.allFinite() || factor.info() != Eigen::Success) return std::nullopt;
  return error.dot(factor.solve(error)) / kDimension;
}

/// The true motion since the start of each epoch.
class TrueEpochPose {
 public:
  TrueEpochPose(const std::vector<OdometryRow>& rows, const std::vector<TrueState>& truth)
      : rows_(rows), truth_(truth) {}

  /// For each row, in their order; empty if it has no estimate. A new epoch starts at the row before its
  /// first estimate, which may be too uncertain to be valid.
  std::optional<Eigen::Isometry3d> at(std::size_t index) {
    if (!rows_[index].hasEstimate()) return std::nullopt;
    if (rows_[index].reset_counter != epoch_) {
      epoch_ = rows_[index].reset_counter;
      start_ = truth_[std::max<std::size_t>(index, 1) - 1].T_world_body;
    }
    if (!start_ || !truth_[index].T_world_body) return std::nullopt;
    return start_->inverse() * *truth_[index].T_world_body;
  }

 private:
  const std::vector<OdometryRow>& rows_;
  const std::vector<TrueState>& truth_;
  std::optional<std::int32_t> epoch_;
  std::optional<Eigen::Isometry3d> start_;
};

}  // namespace

std::vector<ComparedMessage> compareMotion(const std::vector<OdometryRow>& rows, const Trajectory& truth) {
  const vo::Vector6d unknown = vo::Vector6d::Constant(kNaN);
  const std::vector<TrueState> states = trueStates(rows, truth);
  const std::vector<JudgedMessage> judged = judge(rows, states);
  TrueEpochPose epoch_pose(rows, states);
  std::vector<ComparedMessage> compared;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const OdometryRow& row = rows[i];
    ComparedMessage message{row.time_ns, row.valid, row.reasons,
                            unknown,     unknown,   states[i].twist.value_or(unknown),
                            {},          {},        judged[i]};
    const std::optional<Eigen::Isometry3d> true_pose = epoch_pose.at(i);
    if (row.valid) {
      message.twist = row.twist;
      message.twist_stddev = row.twist_covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
      if (!row.twist.isZero())
        message.twist_nees = normalised(row.twist - message.true_twist, row.twist_covariance);
      if (true_pose)
        message.pose_nees =
            normalised(vo::vectorFromMotion(row.T_world_body.inverse() * *true_pose), row.pose_covariance);
    }
    compared.push_back(message);
  }
  return compared;
}

std::vector<JudgedMessage> judgedMessages(const std::vector<ComparedMessage>& messages) {
  std::vector<JudgedMessage> judged;
  for (const ComparedMessage& message : messages)
    judged.push_back(message.judged);
  return judged;
}

}  // namespace cartvo
