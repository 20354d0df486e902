#pragma once

#include <cstdint>

#include "lab/render/scene/campus.hpp"
#include "lab/render/scene/path.hpp"

namespace cartvo::world {

/// Adds a parking garage around the path to an empty campus: a level floor, walls, a low ceiling with beams,
/// and along each straight aisle columns and bays with parked cars.
void addGarage(Campus& campus, const Path& path, std::uint64_t seed);

}  // namespace cartvo::world
