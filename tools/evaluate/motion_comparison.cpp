// Compares published velocities, rates and covariances with the truth.
#include "tools/evaluate/motion_comparison.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "daemon/pipeline/body_motion.hpp"
#include "tools/evaluate/association.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kMinHalfSpan_ns = 25'000'000;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::optional<double> normalised(const vo::Vector6d& error, const vo::Matrix6d& covariance) {
  constexpr double kDimension = 6.0;
  const Eigen::LLT<vo::Matrix6d> factor(covariance);
  if (!covariance.allFinite() || !error.allFinite() || factor.info() != Eigen::Success) return std::nullopt;
  return error.dot(factor.solve(error)) / kDimension;
}

vo::Vector6d trueTwist(const InterpolatedTruth& truth, std::int64_t time_ns) {
  const std::int64_t half_ns = std::max(truth.period_ns(), kMinHalfSpan_ns);
  const auto before = truth.at(time_ns - half_ns), after = truth.at(time_ns + half_ns);
  if (!before || !after) return vo::Vector6d::Constant(kNaN);
  const double seconds = 2e-9 * static_cast<double>(half_ns);
  return daemon::logarithm(before->pose.inverse() * after->pose) / seconds;
}

/// The true motion since the start of each epoch.
class TrueEpochPose {
 public:
  explicit TrueEpochPose(const InterpolatedTruth& truth) : truth_(truth) {}

  /// For valid rows, in their order. `before`: the row before, at which a new epoch starts.
  std::optional<Eigen::Isometry3d> at(const OdometryRow& row, const OdometryRow& before) {
    if (!epoch_ || row.reset_counter != *epoch_) {
      epoch_ = row.reset_counter;
      start_ = truth_.at(before.time_ns);
    }
    const std::optional<StampedPose> now = truth_.at(row.time_ns);
    if (!start_ || !now) return std::nullopt;
    return start_->pose.inverse() * now->pose;
  }

 private:
  const InterpolatedTruth& truth_;
  std::optional<std::int32_t> epoch_;
  std::optional<StampedPose> start_;
};

}  // namespace

std::vector<ComparedMessage> compareMotion(const std::vector<OdometryRow>& rows, const Trajectory& truth) {
  const InterpolatedTruth interpolated(truth);
  TrueEpochPose epoch_pose(interpolated);
  std::vector<ComparedMessage> compared;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const OdometryRow& row = rows[i];
    ComparedMessage message{row.time_ns,
                            row.valid,
                            row.reasons,
                            vo::Vector6d::Constant(kNaN),
                            vo::Vector6d::Constant(kNaN),
                            trueTwist(interpolated, row.time_ns),
                            {},
                            {}};
    if (row.valid) {
      message.twist = row.twist;
      message.twist_stddev = row.twist_covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
      if (!row.twist.isZero())
        message.twist_nees = normalised(row.twist - message.true_twist, row.twist_covariance);
      if (const auto pose = epoch_pose.at(row, rows[std::max<std::size_t>(i, 1) - 1]))
        message.pose_nees =
            normalised(vo::vectorFromMotion(row.T_world_body.inverse() * *pose), row.pose_covariance);
    }
    compared.push_back(message);
  }
  return compared;
}

}  // namespace cartvo
