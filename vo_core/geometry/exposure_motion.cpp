// Motion about another instant and of the rig's other camera.
#include "vo_core/geometry/exposure_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace cartvo::vo {

namespace {

constexpr double kVagueVariance = 1e4;  // (m/s)^2, (rad/s)^2 and the same of accelerations
constexpr int kIterations = 3;          // to a maximum of the likelihood

}  // namespace

RowInformation::Vector vectorOf(const ExposureMotion& motion) {
  RowInformation::Vector components;
  components << motion.velocity, motion.acceleration, motion.angular_jerk;
  return components;
}

ExposureMotion motionOf(const RowInformation::Vector& components) {
  return {components.head<6>(), components.segment<6>(6), components.tail<3>()};
}

MotionBlend::MotionBlend(const RowInformation& rows, const ExposureMotion& expected,
                         const RowInformation::Vector& variances, double freedom, bool use_rows) {
  // The rows alone, with a vague prior where they tell nothing. The jerk keeps its own: a vague one would
  // hide that the velocity differs.
  RowInformation::Vector vague = RowInformation::Vector::Constant(kVagueVariance);
  vague.tail<3>() = variances.tail<3>();
  blend(rows, vague);
  const RowInformation::Vector rows_alone = by_rows, mean = vectorOf(expected);
  squared_difference = (rows_alone - mean).array().square();
  row_variances = covariance.diagonal().array();
  const auto squares = [&](const RowInformation::Vector& at) {
    return ((at - mean).array().square() / variances.array()).eval();
  };
  // Negative logarithm of the likelihood by the rows and by a motion of Student's t distribution.
  const auto cost = [&](const RowInformation::Vector& at) {
    const RowInformation::Vector residual = at - rows_alone;
    return 0.5 * residual.dot(rows.information * residual) +
           0.5 * (freedom + 1.0) * (squares(at) / freedom).log1p().sum();
  };
  // Iteratively reweighted least squares. `agreed`: variances by which the rows are blended at the maximum.
  RowInformation::Vector agreed = variances;
  const auto maximum_near = [&](RowInformation::Vector at) {
    for (int i = 0; i < kIterations; ++i) {
      agreed = variances.array() * (freedom + squares(at)) / (freedom + 1.0);
      blend(rows, agreed);
      at = expected_share * mean + by_rows;
    }
    return at;
  };
  const double near_expected = cost(maximum_near(mean)), near_rows = cost(maximum_near(rows_alone));
  agreed = agreed.cwiseMax(variances);
  use_rows = use_rows || near_rows < near_expected;
  if (use_rows) {
    blend(rows, agreed);
    return;
  }
  expected_share.setIdentity();
  by_rows.setZero();
  covariance = variances.asDiagonal();
}

void MotionBlend::blend(const RowInformation& rows, const RowInformation::Vector& variances) {
  const RowInformation::Vector information = variances.cwiseInverse();
  RowInformation::Matrix sum = rows.information;
  sum.diagonal() += information;
  const Eigen::LDLT<RowInformation::Matrix> factor(sum);
  const RowInformation::Matrix inverse = factor.solve(RowInformation::Matrix::Identity());
  const RowInformation::Vector add = inverse * rows.gradient;
  if (!inverse.allFinite() || !add.allFinite()) return;
  covariance = inverse;
  expected_share = inverse * information.asDiagonal();
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
