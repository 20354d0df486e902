#pragma once

#include <cstdint>

#include "tools/world/mesh.hpp"

namespace cartvo::world {

enum class VehicleKind : std::uint8_t { hatchback, saloon, van, bus };

constexpr int kVehicleKinds = 4;

/// A vehicle on its wheels: x ahead, y left, z up, origin on the ground below its rear axle. Instances give
/// the paint.
Mesh makeVehicle(VehicleKind kind);

/// Distance of its axles, m.
double vehicleWheelbase(VehicleKind kind);

}  // namespace cartvo::world
