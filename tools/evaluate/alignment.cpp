// Fits an estimate to the truth.
#include "tools/evaluate/alignment.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <stdexcept>

#include "calib/model/rotation.hpp"
#include "tools/evaluate/evaluation.hpp"

namespace cartvo {
namespace {

Eigen::Matrix3Xd positionsOf(const Trajectory& trajectory) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(trajectory.size()));
  for (std::size_t i = 0; i < trajectory.size(); ++i)
    positions.col(static_cast<Eigen::Index>(i)) = trajectory[i].pose.translation();
  return positions;
}

/// The constant rotation from the estimate's axes to the truth's that fits all orientations best.
Eigen::Matrix3d axesBetween(const AssociatedTrajectories& associated) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < associated.estimate.size(); ++i)
    sum += associated.estimate[i].pose.linear().transpose() * associated.truth[i].pose.linear();
  return calib::bestRotation(sum);
}

}  // namespace

double alignedError(const AssociatedTrajectories& associated) {
  const Eigen::Matrix3Xd estimate = positionsOf(associated.estimate), truth = positionsOf(associated.truth);
  const Eigen::Isometry3d alignment(Eigen::umeyama(estimate, truth, false));
  const Eigen::Matrix3Xd rest = (alignment.linear() * estimate).colwise() + alignment.translation() - truth;
  return std::sqrt(rest.squaredNorm() / static_cast<double>(estimate.cols()));
}

void fitEstimate(const ComparisonSettings& settings, AssociatedTrajectories& associated) {
  if (!settings.aligns && !settings.corrects_scale) return;
  const Eigen::Matrix3Xd estimate = positionsOf(associated.estimate), truth = positionsOf(associated.truth);
  constexpr double kMinExtent = 0.1;  // m, RMS about the centre
  for (const Eigen::Matrix3Xd& positions : {estimate, truth}) {
    const double squares = (positions.colwise() - positions.rowwise().mean()).squaredNorm();
    if (squares < kMinExtent * kMinExtent * static_cast<double>(positions.cols()))
      throw std::runtime_error("a standstill has no path to fit; leave out --align and --correct-scale");
  }
  const Eigen::Matrix4d fit = Eigen::umeyama(estimate, truth, settings.corrects_scale);
  if (settings.corrects_scale) associated.scale = std::cbrt(fit.topLeftCorner<3, 3>().determinant());
  associated.is_aligned = settings.aligns;
  const Eigen::Matrix3d R = fit.topLeftCorner<3, 3>() / associated.scale;
  for (StampedPose& stamped : associated.estimate) {
    stamped.pose.translation() *= associated.scale;
    if (!settings.aligns) continue;
    stamped.pose.translation() = R * stamped.pose.translation() + fit.topRightCorner<3, 1>();
    stamped.pose.linear() = R * stamped.pose.linear();
  }
  if (!settings.aligns) return;
  const Eigen::Matrix3d axes = axesBetween(associated);
  for (StampedPose& stamped : associated.estimate)
    stamped.pose.linear() = stamped.pose.linear() * axes;
}

Trajectory placedEstimate(const AssociatedTrajectories& associated) {
  if (associated.is_aligned) return associated.estimate;
  return startingAt(associated.truth.front().pose, associated.estimate);
}

const char* placementName(const AssociatedTrajectories& associated) {
  return associated.is_aligned ? "aligned" : "starts coincide";
}

}  // namespace cartvo
