#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace cartvo::world {

/// A place on a path.
struct PathPoint {
  Eigen::Vector2d position;  ///< m
  Eigen::Vector2d tangent;   ///< unit length
  double curvature = 0.0;    ///< 1/m, positive to the left

  /// `lateral` metres to the left of the path.
  Eigen::Vector2d beside(double lateral) const {
    return position + lateral * Eigen::Vector2d(-tangent.y(), tangent.x());
  }
};

/// A closed line in the plane, a periodic cubic B-spline measured by its length.
class Path {
 public:
  /// A closed polygon with its corners rounded to arcs of `radius`, m, whose curvature begins and ends
  /// gently.
  Path(const std::vector<Eigen::Vector2d>& polygon, double radius);

  double length() const { return arc_length_.back(); }

  /// At `distance` along it, m; any number, the path is gone round again.
  PathPoint at(double distance) const;

 private:
  Eigen::Vector2d derivative(double parameter, int order) const;

  std::vector<Eigen::Vector2d> control_;
  std::vector<double> arc_length_;  ///< at parameters k / kSubdivision
};

}  // namespace cartvo::world
