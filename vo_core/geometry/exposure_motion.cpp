// Motion about another instant and of the rig's other camera.
#include "vo_core/geometry/exposure_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace cartvo::vo {

namespace {

constexpr double kVagueVariance = 1e4;  // (m/s)^2, (rad/s)^2 and the same of accelerations

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
                         const RowInformation::Vector& variances, bool use_rows) {
  // The rows alone, with a vague prior where they tell nothing. The jerk keeps its own: a vague one would
  // hide that the velocity differs.
  RowInformation::Vector vague = RowInformation::Vector::Constant(kVagueVariance);
  vague.tail<3>() = variances.tail<3>();
  blend(rows, vague);
  squared_difference = (by_rows - vectorOf(expected)).array().square();
  row_variances = covariance.diagonal().array();
  // Where the difference is significant, it is the best estimate of its own variance.
  RowInformation::Vector agreed = variances;
  for (const int first : {0, 3}) {
    const double difference = squared_difference.segment<3>(first).mean();
    const double prior = variances.segment<3>(first).mean();
    if (difference < kSignificance * (prior + row_variances.segment<3>(first).mean())) continue;
    use_rows = true;
    const double factor = difference / prior;
    agreed.segment<3>(first) *= factor;
    agreed.segment<3>(6 + first) *= factor;
    if (first == 3) agreed.tail<3>() *= factor;
  }
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
