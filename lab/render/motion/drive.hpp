#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "lab/render/motion/speed_profile.hpp"
#include "lab/render/motion/uniform_spline.hpp"
#include "lab/render/scene/path.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// The cart's motion: along a path, at the scenario's speed limited by bends, motor and brakes, on springs
/// excited by the road's roughness and by acceleration. A lively drive weaves about the path and meets kerbs
/// and bumps. All quantities are twice continuously differentiable in time.
class Drive {
 public:
  /// `path` must outlive the drive.
  Drive(const Path& path, const WorldSettings& settings);

  double distance(double seconds) const { return speed_.integral(seconds); }  ///< m along the path
  double speed(double seconds) const { return speed_.value(seconds); }        ///< m/s, negative: backward

  /// Pose of the body (REP-103 axes, origin on the ground below the rear axle) in campus axes, at `seconds`.
  Eigen::Isometry3d T_map_body(double seconds) const;

 private:
  /// Place and heading of a lively drive over time, in campus axes.
  struct Course {
    UniformSpline x, y;  ///< m
    UniformSpline yaw;   ///< rad
  };

  Course weavingCourse(int steps) const;
  PathPoint placeAt(double seconds) const;

  const Path& path_;
  Terrain terrain_;
  Weave weave_;
  UniformSpline speed_;
  std::optional<Course> course_;      ///< of a lively drive; else the path itself
  UniformSpline heave_;               ///< m
  UniformSpline pitch_;               ///< rad, nose down is positive
  UniformSpline roll_;                ///< rad, left side up is positive
  std::optional<UniformSpline> yaw_;  ///< rad, to the left, of a rough road's kicks
};

}  // namespace cartvo::world
