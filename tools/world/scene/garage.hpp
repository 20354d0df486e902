#pragma once

#include <cstdint>

#include "tools/world/scene/campus.hpp"
#include "tools/world/scene/path.hpp"

namespace cartvo::world {

/// Adds a parking garage around the path to an empty campus: a level floor, walls, a low ceiling with beams,
/// and along each straight aisle columns and bays with parked cars.
void addGarage(Campus& campus, const Path& path, std::uint64_t seed);

}  // namespace cartvo::world
