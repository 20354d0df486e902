#pragma once

#include <memory>

#include "vo_core/odometry_method.hpp"

namespace cartvo {

/// The method of the thesis, every stage of it: `estimator: thesis`. Treats left and right as simultaneous.
std::unique_ptr<OdometryMethod> makeThesisOdometry(const StereoCamera& camera,
                                                   const OdometrySettings& settings);

}  // namespace cartvo
