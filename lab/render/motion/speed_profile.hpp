#pragma once

#include <array>
#include <vector>

#include "lab/render/scene/path.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Lateral deviation of a lively drive from its path: two sines of the distance along the path, the same in
/// each lap. Zero in a calm drive.
class Weave {
 public:
  Weave(const Path& path, const WorldSettings& settings);

  double lateral(double distance) const;    ///< m to the left of the path, at most kMaximum
  double slope(double distance) const;      ///< derivative of lateral by the distance
  double curvature(double distance) const;  ///< second derivative, 1/m

  static constexpr double kMaximum = 0.4;  ///< m

 private:
  struct Sine {
    double amplitude = 0.0;    ///< m
    double wave_number = 0.0;  ///< rad/m
    double phase = 0.0;        ///< rad
  };
  std::array<Sine, 2> sines_;
};

constexpr double kSpeedStep = 0.02;  ///< s, step of the profile

/// Steps of the profile: until two seconds after the last pair.
int speedSteps(const WorldSettings& settings);

/// The cart's speed at each kSpeedStep, m/s, negative backward: the scenario's speed limited by bends, motor
/// and brakes, and smoothed. Zero during the lead-in.
std::vector<double> speedProfile(const Path& path, const Weave& weave, const WorldSettings& settings);

}  // namespace cartvo::world
