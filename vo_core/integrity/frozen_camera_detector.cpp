// Detection of a frozen left camera by the right camera's motion.
#include "vo_core/integrity/frozen_camera_detector.hpp"

#include <algorithm>
#include <cmath>

#include "vo_core/fixed_constants.hpp"

namespace cartvo::vo {

FrozenCameraDetector::Start FrozenCameraDetector::startAt(const RightDisplacement& displacement,
                                                          std::int64_t exposure_ns) const {
  StandstillSettings limits = settings_;
  // Two displacements are compared, each of which errs. In the dark that is more than the limits.
  const Vector6d noise = std::sqrt(2.0) * settings_.motion_significance * displacement.stddev;
  limits.translation = std::max(frozen_camera::kLimitFactor * limits.translation, noise.head<3>().norm());
  limits.rotation = std::max(frozen_camera::kLimitFactor * limits.rotation, noise.tail<3>().norm());
  return {displacement, exposure_ns, limits};
}

void FrozenCameraDetector::start(const RightDisplacement& displacement, std::int64_t exposure_ns,
                                 const Vector6d& slack) {
  start_ = startAt(displacement, exposure_ns);
  start_->limits.translation += slack.head<3>().norm();
  start_->limits.rotation += slack.tail<3>().norm();
}

RightMotion FrozenCameraDetector::update(const std::optional<RightDisplacement>& displacement,
                                         std::int64_t exposure_ns, bool left_repeats) {
  const int landmarks = start_->displacement.landmarks;
  if (!displacement || displacement->landmarks < frozen_camera::kMinimumLandmarkShare * landmarks) {
    // The cause may be glare or a bus, unless the left image repeats.
    start_->since_ns = exposure_ns;
    return left_repeats ? RightMotion::moves : RightMotion::unknown;
  }
  const Start now = startAt(*displacement, exposure_ns);
  if (StandstillDetector(start_->limits)
          .exceedsLimits(start_->displacement.motion.inverse() * now.displacement.motion)) {
    start_ = now;
    start_->displacement.landmarks = landmarks;  // kept: their number falls with each pair
    return RightMotion::moves;
  }
  if (1e-9 * static_cast<double>(exposure_ns - start_->since_ns) < settings_.least_time)
    return RightMotion::unknown;
  // The right camera stands at this place: extrapolations from before the stop no longer apply.
  start_ = now;
  return RightMotion::stays;
}

}  // namespace cartvo::vo
