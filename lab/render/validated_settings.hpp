#pragma once

#include "lab/render/world_settings.hpp"

namespace cartvo::world {

/// Returns the settings. Throws std::invalid_argument that names the first one out of its range.
const WorldSettings& validated(const WorldSettings& settings);

}  // namespace cartvo::world
