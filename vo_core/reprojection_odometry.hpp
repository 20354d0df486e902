#pragma once

#include <memory>

#include "vo_core/odometry_method.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/shutter.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/stereo_masks.hpp"

namespace cartvo::vo {

/// `estimator: reprojection`: robust least squares over a window of pairs on the reprojection error in both
/// images, each at its own exposure instant.
std::unique_ptr<OdometryMethod> makeReprojectionOdometry(const StereoCamera& camera,
                                                         const OdometrySettings& settings,
                                                         const StereoShutters& shutters,
                                                         const StereoMasks& masks);

}  // namespace cartvo::vo
