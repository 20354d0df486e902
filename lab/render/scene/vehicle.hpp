#pragma once

#include <cstdint>

#include "lab/render/scene/mesh.hpp"

namespace cartvo::world {

enum class VehicleKind : std::uint8_t { hatchback, saloon, van, bus };

constexpr int kVehicleKinds = 4;

/// A vehicle: x ahead, y left, z up, origin on the ground below the rear axle. Instances select the paint.
Mesh makeVehicle(VehicleKind kind);

/// Distance between the axles, m.
double vehicleWheelbase(VehicleKind kind);

}  // namespace cartvo::world
