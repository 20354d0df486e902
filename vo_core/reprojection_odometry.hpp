#pragma once

#include <memory>

#include "vo_core/odometry_method.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/shutter.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/stereo_masks.hpp"

namespace cartvo::vo {

/// `estimator: reprojection`: the most likely continuous trajectory by the reprojection errors in both images
/// of a window of pairs, each coordinate at the instant of its own row.
std::unique_ptr<OdometryMethod> makeReprojectionOdometry(const StereoCamera& camera,
                                                         const OdometrySettings& settings,
                                                         const StereoShutters& shutters,
                                                         const StereoMasks& masks);

}  // namespace cartvo::vo
