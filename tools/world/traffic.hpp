#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "tools/world/campus.hpp"
#include "tools/world/drive.hpp"
#include "tools/world/path.hpp"

namespace cartvo::world {

/// Vehicles and people that move. Where they are is a function of time alone, smooth in it.
class Traffic {
 public:
  /// Appends the movers' meshes and instances to `campus`. `path` and `drive` must outlive this.
  Traffic(const Path& path, const Drive& drive, const WorldSettings& settings, Campus& campus);

  /// Moves the instances to where they are at `seconds`.
  void placeAt(double seconds, std::vector<Instance>& instances) const;

 private:
  /// How a vehicle finds its place on the road.
  enum class Course : std::uint8_t {
    oncoming,    ///< against the cart's direction, in the other lane
    ahead,       ///< in the cart's lane, at a distance that breathes
    overtaking,  ///< past the standing cart and into its lane before it
  };
  struct Vehicle {
    std::uint32_t instance = 0;
    Course course = Course::oncoming;
    double start = 0.0;  ///< m along the path at time 0, or the mean distance ahead
    double speed = 0.0;  ///< m/s, or the share by which the distance ahead breathes
    double phase = 0.0;
    double wheelbase = 2.6;
  };
  struct Pedestrian {
    std::uint32_t first_instance = 0;  ///< of five
    double start = 0.0;
    double speed = 0.0;  ///< negative: against the path
    double lateral = 0.0;
    double scale = 1.0;
  };

  void addVehicles(const WorldSettings& settings, Campus& campus);
  void addPedestrians(const WorldSettings& settings, Campus& campus);
  Eigen::Isometry3d vehiclePose(const Vehicle& vehicle, double seconds) const;

  const Path& path_;
  const Drive& drive_;
  std::vector<Vehicle> vehicles_;
  std::vector<Pedestrian> pedestrians_;
};

}  // namespace cartvo::world
