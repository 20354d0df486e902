#pragma once

#include <memory>

#include "vo_core/odometry_method.hpp"
#include "vo_core/odometry_settings.hpp"
#include "vo_core/stereo_camera.hpp"
#include "vo_core/stereo_masks.hpp"

namespace cartvo::vo {

/// `estimator: thesis`: the method of the thesis with all its stages. Treats left and right exposure as
/// simultaneous.
std::unique_ptr<OdometryMethod> makeThesisOdometry(const StereoCamera& camera,
                                                   const OdometrySettings& settings,
                                                   const StereoMasks& masks);

}  // namespace cartvo::vo
