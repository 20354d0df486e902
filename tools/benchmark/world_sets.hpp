#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "lab/render/world_settings.hpp"

// The one place that says which rendered worlds may choose a number of the estimator and which report it.
// Each scenario and each seed belongs to exactly one set, so that the sets share neither.

namespace cartvo::benchmark {

enum class WorldSet : std::uint8_t {
  tuning,     ///< worlds on which numbers of the estimator are chosen
  reporting,  ///< worlds that take no part in choosing and are reported
};

/// "tuning" or "reporting".
std::string_view worldSetName(WorldSet set);

/// The set of a name. Throws std::invalid_argument if there is none.
WorldSet worldSetNamed(std::string_view name);

WorldSet setOf(world::Scenario scenario);

/// Seeds below 10 belong to the tuning set, all others to the reporting set.
WorldSet setOfSeed(std::uint64_t seed);

/// The set of both the scenario and the seed; nothing if theirs differ: such a world is of neither set.
std::optional<WorldSet> setOf(const world::WorldSettings& world);

/// The drives of a set: its scenarios in the order of the enumeration, then some of them as lively drives.
std::vector<world::WorldSettings> drivesOf(WorldSet set);

/// The seed with which worlds of the set are rendered unless others are given: 1 or 11.
std::uint64_t defaultSeed(WorldSet set);

}  // namespace cartvo::benchmark
