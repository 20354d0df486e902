#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace cartvo::world {

/// Position, direction and curvature at a point of a path.
struct PathPoint {
  Eigen::Vector2d position;  ///< m, campus axes
  Eigen::Vector2d tangent;   ///< unit length
  double curvature = 0.0;    ///< 1/m, positive to the left

  /// The point `lateral` m to the left of the path.
  Eigen::Vector2d beside(double lateral) const {
    return position + lateral * Eigen::Vector2d(-tangent.y(), tangent.x());
  }
};

/// A closed path in the plane: a periodic cubic B-spline parametrised by arc length.
class Path {
 public:
  /// Rounds the corners of a closed polygon to arcs of `radius`, m, and smooths the changes of curvature.
  Path(const std::vector<Eigen::Vector2d>& polygon, double radius);

  /// Length of one lap, m.
  double length() const { return arc_length_.back(); }

  /// The point at `distance` along the path, m; values outside [0, length()) wrap around.
  PathPoint at(double distance) const;

 private:
  Eigen::Vector2d derivative(double parameter, int order) const;

  std::vector<Eigen::Vector2d> control_;
  std::vector<double> arc_length_;  ///< at parameters k / kSubdivision
};

/// Height of the ground: a smooth sum of sines.
struct Terrain {
  double relief = 1.0;      ///< factor on the heights of the hills
  double land_depth = 0.0;  ///< m, by which the land beside the road lies below it

  /// Height of the road at campus position (x, y), m.
  double height(double x, double y) const;

  /// Height of the land beside the road, m.
  double landHeight(double x, double y) const { return height(x, y) - land_depth; }
};

/// Pose on the ground at `point` of a path, `lateral` m to its left, of a vehicle with axles `wheelbase` m
/// apart: x along the path, y left, z up; origin below the rear axle.
Eigen::Isometry3d groundPose(const Terrain& terrain, const PathPoint& point, double lateral,
                             double wheelbase);

}  // namespace cartvo::world
