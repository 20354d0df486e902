// Motion about another instant and of the rig's other camera.
#include "vo_core/geometry/exposure_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace cartvo::vo {

namespace {

constexpr double kVagueVariance = 1e4;  // (m/s)^2, (rad/s)^2 and the same of accelerations
constexpr double kSignificance = 8.0;   // variances of a difference that may be by chance

RowInformation::Vector vectorOf(const ExposureMotion& motion) {
  RowInformation::Vector vector;
  vector << motion.velocity, motion.acceleration;
  return vector;
}

}  // namespace

MotionBlend::MotionBlend(const RowInformation& rows, const ExposureMotion& expected,
                         const RowInformation::Vector& variances) {
  // The rows alone, with a vague prior where they tell nothing.
  blend(rows, RowInformation::Vector::Constant(kVagueVariance));
  const RowInformation::Array squares = (by_rows - vectorOf(expected)).array().square();
  const RowInformation::Array expected_squares = variances.array() + covariance.diagonal().array();
  // Where the difference is significant, it is the best estimate of its own variance.
  const RowInformation::Array agreed = variances.array().max(squares - kSignificance * expected_squares);
  excess = agreed - variances.array();
  blend(rows, agreed);
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
  const RowInformation::Vector blended = expected_share * vectorOf(expected) + by_rows;
  return {blended.head<6>(), blended.tail<6>()};
}

ExposureMotion motionAbout(const ExposureMotion& motion, double instant,
                           const Eigen::Isometry3d& T_camera_other, double range) {
  const Eigen::Isometry3d from = (motion.at(instant) * T_camera_other).inverse();
  const Vector6d after = vectorFromMotion(from * motion.at(instant + range) * T_camera_other);
  const Vector6d before = vectorFromMotion(from * motion.at(instant - range) * T_camera_other);
  return {(after - before) / (2.0 * range), (after + before) / (range * range)};
}

}  // namespace cartvo::vo
