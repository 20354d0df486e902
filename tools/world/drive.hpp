#pragma once

#include <Eigen/Geometry>

#include "tools/world/path.hpp"
#include "tools/world/uniform_spline.hpp"
#include "tools/world/world_settings.hpp"

namespace cartvo::world {

/// How the cart moves: along a path, at a speed that its scenario, its brakes and the bends allow, on springs
/// that answer to the road's roughness and to acceleration. Every quantity is twice continuously
/// differentiable in time.
class Drive {
 public:
  /// `path` must outlive the drive.
  Drive(const Path& path, const WorldSettings& settings);

  double distance(double seconds) const { return speed_.integral(seconds); }  ///< along the path, m
  double speed(double seconds) const { return speed_.value(seconds); }        ///< m/s, negative: backward

  /// Body axes (REP-103, origin on the ground below the rear axle) in the campus' axes.
  Eigen::Isometry3d T_map_body(double seconds) const;

 private:
  const Path& path_;
  UniformSpline speed_;
  UniformSpline heave_;  ///< m
  UniformSpline pitch_;  ///< rad, nose down is positive
  UniformSpline roll_;   ///< rad, left side up is positive
};

}  // namespace cartvo::world
