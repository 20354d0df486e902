// Detection of a frozen left camera by the right camera's motion.
#include "vo_core/integrity/frozen_camera_detector.hpp"

#include <utility>

#include "vo_core/estimation/pose_search.hpp"
#include "vo_core/fixed_constants.hpp"

namespace cartvo::vo {
namespace {

/// Two displacements are compared, each of which errs.
StandstillSettings limitsOf(StandstillSettings settings) {
  settings.translation *= frozen_camera::kLimitFactor;
  settings.rotation *= frozen_camera::kLimitFactor;
  return settings;
}

}  // namespace

FrozenCameraDetector::FrozenCameraDetector(const StandstillSettings& settings)
    : settings_(settings), limits_(limitsOf(settings)) {}

void FrozenCameraDetector::start(const RightDisplacement& displacement, std::int64_t exposure_ns,
                                 const Vector6d& slack) {
  start_ = Start{displacement, exposure_ns, {}};
  const Vector6d largest = slack / settings_.motion_significance;
  auto variances = start_->displacement.covariance.diagonal();
  variances.head<3>().array() += largest.head<3>().squaredNorm();
  variances.tail<3>().array() += largest.tail<3>().squaredNorm();
}

/// Whether the right camera has moved since the start: by far, or in two pairs in a row the same way. Errors
/// of a codec are large at times, but then others in the next pair.
bool FrozenCameraDetector::hasMoved(const RightDisplacement& now) {
  const RightDisplacement& before = start_->displacement;
  const Eigen::Isometry3d motion = before.motion.inverse() * now.motion;
  const Matrix6d covariance = before.covariance + now.covariance;
  const auto last = std::exchange(start_->departure, std::nullopt);
  if (limits_.isExceededBy(motion, kWideGate * kWideGate * covariance)) return true;
  if (!limits_.isExceededBy(motion, covariance)) return false;
  start_->departure = vectorFromMotion(motion);
  return last && limits_.isExceededBy(motionFromVector(0.5 * (*last + *start_->departure)), covariance);
}

RightMotion FrozenCameraDetector::update(const std::optional<RightDisplacement>& displacement,
                                         std::int64_t exposure_ns, bool left_repeats) {
  const RightDisplacement& before = start_->displacement;
  if (!displacement || displacement->landmarks < frozen_camera::kMinimumLandmarkShare * before.landmarks) {
    // The cause may be glare or a bus, unless the left image repeats.
    start_->since_ns = exposure_ns;
    return left_repeats ? RightMotion::moves : RightMotion::unknown;
  }
  if (hasMoved(*displacement)) {
    const int landmarks = before.landmarks;  // kept: their number falls with each pair
    start_ = Start{*displacement, exposure_ns, {}};
    start_->displacement.landmarks = landmarks;
    return RightMotion::moves;
  }
  if (1e-9 * static_cast<double>(exposure_ns - start_->since_ns) < settings_.least_time)
    return RightMotion::unknown;
  // The right camera stands at this place: extrapolations from before the stop no longer apply.
  start_ = Start{*displacement, exposure_ns, {}};
  return RightMotion::stays;
}

}  // namespace cartvo::vo
