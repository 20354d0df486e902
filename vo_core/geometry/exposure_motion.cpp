// Motion about another instant and of the rig's other camera.
#include "vo_core/geometry/exposure_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace cartvo::vo {

namespace {

constexpr double kVagueVariance = 1e4;  // (m/s)^2, (rad/s)^2 and the same of accelerations
constexpr int kIterations = 3;          // to a maximum of the likelihood

/// The most likely motion by the rows and by a normal prior of this mean and these inverse variances.
RowInformation::Vector mostLikely(const RowInformation& rows, const RowInformation::Vector& mean,
                                  const RowInformation::Vector& prior_information) {
  RowInformation::Matrix sum = rows.information;
  sum.diagonal() += prior_information;
  return Eigen::LDLT<RowInformation::Matrix>(sum).solve(rows.gradient + prior_information.cwiseProduct(mean));
}

/// A maximum of the likelihood by rows and a prior.
struct Maximum {
  RowInformation::Vector motion;
  RowInformation::Vector prior_information;  ///< of the normal prior that has its maximum there, too
};

/// The maximum near `start`, by iteratively reweighted least squares.
Maximum maximumNear(const RowInformation::Vector& start, const RowInformation& rows,
                    const MotionPrior& prior) {
  Maximum maximum{start, prior.variances.cwiseInverse()};
  for (int i = 0; i < kIterations; ++i) {
    maximum.prior_information = prior.informationAt(maximum.motion);
    maximum.motion = mostLikely(rows, prior.mean, maximum.prior_information);
  }
  return maximum;
}

}  // namespace

RowInformation::Vector vectorOf(const ExposureMotion& motion) {
  RowInformation::Vector components;
  components << motion.velocity, motion.acceleration, motion.angular_jerk;
  return components;
}

ExposureMotion motionOf(const RowInformation::Vector& components) {
  return {components.head<6>(), components.segment<6>(6), components.tail<3>()};
}

RowInformation::Vector MotionPrior::informationAt(const RowInformation::Vector& motion) const {
  const auto squares = (motion - mean).array().square() / variances.array();
  return (freedom + 1.0) / ((freedom + squares) * variances.array());
}

double MotionPrior::costAt(const RowInformation::Vector& motion) const {
  const auto squares = (motion - mean).array().square() / variances.array();
  return 0.5 * (freedom + 1.0) * (squares / freedom).log1p().sum();
}

MotionBlend::MotionBlend(const RowInformation& rows, const MotionPrior& prior)
    : covariance(prior.variances.asDiagonal()) {
  // The rows alone, with a vague prior where they tell nothing. The jerk keeps its own: a vague one would
  // hide that the velocity differs.
  RowInformation::Vector vague = RowInformation::Vector::Constant(1.0 / kVagueVariance);
  const RowInformation::Vector information = prior.variances.cwiseInverse();
  vague.tail<3>() = information.tail<3>();
  const RowInformation::Vector rows_alone = mostLikely(rows, RowInformation::Vector::Zero(), vague);
  const auto cost = [&](const RowInformation::Vector& motion) {
    const RowInformation::Vector residual = motion - rows_alone;
    return 0.5 * residual.dot(rows.information * residual) + prior.costAt(motion);
  };
  const Maximum near_rows = maximumNear(rows_alone, rows, prior);
  const Maximum near_prior = maximumNear(prior.mean, rows, prior);
  const Maximum& best = cost(near_rows.motion) < cost(near_prior.motion) ? near_rows : near_prior;

  const RowInformation::Vector prior_information = best.prior_information.cwiseMin(information);
  RowInformation::Matrix sum = rows.information;
  sum.diagonal() += prior_information;
  const RowInformation::Matrix inverse =
      Eigen::LDLT<RowInformation::Matrix>(sum).solve(RowInformation::Matrix::Identity());
  const RowInformation::Vector add = inverse * rows.gradient;
  // Eigen's factorisation leaves out a pivot that is no number, and the rest looks like a solution.
  if (!rows.information.allFinite() || !inverse.allFinite() || !add.allFinite()) return;
  covariance = inverse;
  expected_share = inverse * prior_information.asDiagonal();
  by_rows = add;
}

RowInformation withMapError(const RowInformation& rows, const RowInformation::Matrix& covariance) {
  // (I^-1 + C)^-1 = (1 + I C)^-1 I, where I may be singular.
  const RowInformation::Matrix factor =
      (RowInformation::Matrix::Identity() + rows.information * covariance).inverse();
  const RowInformation::Matrix information = factor * rows.information;
  return {0.5 * (information + information.transpose()), factor * rows.gradient};
}

ExposureMotion MotionBlend::of(const ExposureMotion& expected) const {
  return motionOf(expected_share * vectorOf(expected) + by_rows);
}

ExposureMotion motionAbout(const ExposureMotion& motion, double instant,
                           const Eigen::Isometry3d& T_camera_other, double range) {
  const Eigen::Isometry3d from = (motion.at(instant) * T_camera_other).inverse();
  const Vector6d after = vectorFromMotion(from * motion.at(instant + range) * T_camera_other);
  const Vector6d before = vectorFromMotion(from * motion.at(instant - range) * T_camera_other);
  // The jerk of the rotation alone is the same, in the other camera's axes.
  const Eigen::Vector3d angular_jerk = from.linear() * motion.angular_jerk;
  Vector6d velocity = (after - before) / (2.0 * range);
  velocity.tail<3>() -= range * range / 6.0 * angular_jerk;
  return {velocity, (after + before) / (range * range), angular_jerk};
}

}  // namespace cartvo::vo
