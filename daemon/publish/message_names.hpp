#pragma once

#include <cstdint>
#include <string>

namespace cartvo::daemon {

/// Names of the bits in odometry_t.reasons, for example "too few matches, high residual".
std::string reasonNames(std::int32_t reasons);

/// Name of a value of camera_health_t.state, such as "streaming"; "unknown" for one of a later version.
const char* cameraStateName(int state);

/// Name of a value of health_t.odometry_state, such as "left camera frozen"; "unknown" for one of a later
/// version.
const char* odometryStateName(int state);

/// Name of a value of camera_health_t.instant_source, such as "sender reports"; "unknown" for one of a later
/// version.
const char* instantSourceName(int source);

}  // namespace cartvo::daemon
