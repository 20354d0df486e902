#pragma once

#include <vector>

#include "lab/render/motion/weave.hpp"
#include "lab/render/scene/path.hpp"
#include "lab/render/world_settings.hpp"

namespace cartvo::world {

constexpr double kSpeedStep = 0.02;  ///< s, step of the profile

/// Steps of the profile: until two seconds after the last pair.
int speedSteps(const WorldSettings& settings);

/// The cart's speed at each kSpeedStep, m/s, negative backward: the scenario's speed limited by bends, motor
/// and brakes, and smoothed. Zero during the lead-in.
std::vector<double> speedProfile(const Path& path, const Weave& weave, const WorldSettings& settings);

}  // namespace cartvo::world
