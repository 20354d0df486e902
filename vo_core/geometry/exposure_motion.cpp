// Motion about another instant and of the rig's other camera.
#include "vo_core/geometry/exposure_motion.hpp"

#include <Eigen/Cholesky>

namespace cartvo::vo {

MotionBlend::MotionBlend(const RowInformation& rows, const RowInformation::Vector& variances) {
  RowInformation::Matrix sum = rows.information;
  sum.diagonal() += variances.cwiseInverse();
  const Eigen::LDLT<RowInformation::Matrix> factor(sum);
  const RowInformation::Matrix share = factor.solve(
      RowInformation::Matrix(variances.cwiseInverse().asDiagonal()));
  const RowInformation::Vector add = factor.solve(rows.gradient);
  if (!share.allFinite() || !add.allFinite()) return;
  expected_share = share;
  by_rows = add;
}

ExposureMotion MotionBlend::of(const ExposureMotion& expected) const {
  RowInformation::Vector vector;
  vector << expected.velocity, expected.acceleration;
  const RowInformation::Vector blended = expected_share * vector + by_rows;
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
