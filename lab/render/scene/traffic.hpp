#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "lab/render/motion/drive.hpp"
#include "lab/render/scenario_traits.hpp"
#include "lab/render/scene/campus.hpp"
#include "lab/render/scene/path.hpp"
#include "lab/render/surface/hash.hpp"

namespace cartvo::world {

/// Moving vehicles and pedestrians. Their poses are smooth functions of time alone.
class Traffic {
 public:
  /// Appends the meshes and instances of the moving objects to `campus`. `path` and `drive` must outlive this
  /// object.
  Traffic(const Path& path, const Drive& drive, const WorldSettings& settings, Campus& campus);

  /// Sets the placements of the moving instances to those at `seconds`.
  void placeAt(double seconds, std::vector<Instance>& instances) const;

 private:
  /// Course of a vehicle relative to the cart.
  enum class Course : std::uint8_t {
    oncoming,    ///< against the cart's direction, in the other lane
    ahead,       ///< in the cart's lane, at a distance that oscillates
    overtaking,  ///< past the cart at standstill and into its lane ahead of it
  };
  struct Vehicle {
    std::uint32_t instance = 0;
    Course course = Course::oncoming;
    double start = 0.0;      ///< m along the path at time 0; `ahead`: mean distance to the cart, m
    double speed = 0.0;      ///< m/s; `ahead`: relative amplitude of the distance
    double phase = 0.0;      ///< rad, of that oscillation
    double wheelbase = 2.6;  ///< m
  };
  struct Pedestrian {
    std::uint32_t first_instance = 0;  ///< of five: torso, legs, arms
    double start = 0.0;                ///< m along the path at time 0
    double speed = 0.0;                ///< m/s, negative: against the path
    double lateral = 0.0;              ///< m left of the path
    double height = 0.12;              ///< m above the road, of the ground below the feet
    double scale = 1.0;
    double sway = 0.0;     ///< m, amplitude of the lateral position
    double phase = 0.0;    ///< rad, of that oscillation
    bool escorts = false;  ///< keeps its distance `start` to the cart
  };

  void addVehicles(const WorldSettings& settings, Campus& campus);
  void addPedestrians(const WorldSettings& settings, Campus& campus);
  /// People on the whole width of the road, and some who walk ahead of the cart.
  void addCrowd(const WorldSettings& settings, Campus& campus);
  void addPerson(Pedestrian person, std::uint32_t torso, Campus& campus, Random& random);
  Eigen::Isometry3d vehiclePose(const Vehicle& vehicle, double seconds) const;
  Eigen::Isometry3d personPose(const Pedestrian& person, double seconds) const;
  /// m along the path since time 0.
  double walked(const Pedestrian& person, double seconds) const;

  const Path& path_;
  const Drive& drive_;
  const ScenarioTraits traits_;
  std::vector<Vehicle> vehicles_;
  std::vector<Pedestrian> pedestrians_;
};

}  // namespace cartvo::world
