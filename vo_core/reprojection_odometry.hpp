#pragma once

#include <memory>

#include "vo_core/odometry_method.hpp"

namespace cartvo {

/// Robust least squares on the reprojection error in both images, each at its own instant, over a window of
/// pairs: `estimator: reprojection`.
std::unique_ptr<OdometryMethod> makeReprojectionOdometry(const StereoCamera& camera,
                                                         const OdometrySettings& settings);

}  // namespace cartvo
