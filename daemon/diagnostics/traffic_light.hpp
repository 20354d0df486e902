#pragma once

#include <cstdint>
#include <string>

#include "daemon/diagnostics/metrics.hpp"

// One word for the odometry and both cameras, as the status page shows it.

namespace cartvo::daemon {

enum class Light : std::uint8_t {
  driving,     ///< odometry is valid
  standstill,  ///< valid too
  invalid,     ///< both cameras deliver pictures, or are said to
  no_camera,   ///< at least one camera delivers none
};

struct TrafficLight {
  Light light = Light::no_camera;
  std::string cause;  ///< or, while valid, the problem to fix; empty: none
  std::string topic;  ///< words of docs/troubleshooting.md where the cause is treated
};

/// "driving", "standstill", "invalid" or "no_camera".
const char* lightName(Light light);

TrafficLight trafficLight(const DaemonState& state, DaemonState::Clock::time_point now);

}  // namespace cartvo::daemon
