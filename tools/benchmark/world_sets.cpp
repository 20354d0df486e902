// Assigns scenarios and seeds to the tuning set or to the reporting set.
#include "tools/benchmark/world_sets.hpp"

#include <array>
#include <stdexcept>
#include <string>

namespace cartvo::benchmark {
namespace {

using world::Scenario;

constexpr std::uint64_t kFirstReportingSeed = 10;

/// The scenarios that are driven in a lively way, too: winding and wide roads, traffic, stops, rough ground,
/// narrow ways, hills, a dark place, drops on the lens.
constexpr std::array kLivelyScenarios{
    Scenario::campus, Scenario::turns,  Scenario::traffic, Scenario::stop_and_go, Scenario::bumpy,
    Scenario::garage, Scenario::hedges, Scenario::rain,    Scenario::slope,       Scenario::crowd};

}  // namespace

std::string_view worldSetName(WorldSet set) {
  return set == WorldSet::tuning ? "tuning" : "reporting";
}

WorldSet worldSetNamed(std::string_view name) {
  for (const WorldSet set : {WorldSet::tuning, WorldSet::reporting})
    if (worldSetName(set) == name) return set;
  throw std::invalid_argument("no set of worlds named '" + std::string(name) +
                              "'; there are: tuning, reporting");
}

// Without a default: the compiler asks for the set of a new scenario.
WorldSet setOf(Scenario scenario) {
  switch (scenario) {
    case Scenario::campus:
    case Scenario::loop:
    case Scenario::turns:
    case Scenario::traffic:
    case Scenario::standing:
    case Scenario::stop_and_go:
    case Scenario::exposure:
    case Scenario::underpass:
    case Scenario::glare:
    case Scenario::dusk:
    case Scenario::low_texture:
    case Scenario::bumpy:
    case Scenario::reversing:
    case Scenario::motorway:
    case Scenario::rough:
    case Scenario::rough_road:
      return WorldSet::tuning;
    case Scenario::garage:
    case Scenario::hedges:
    case Scenario::rain:
    case Scenario::flicker:
    case Scenario::slope:
    case Scenario::bridge:
    case Scenario::crowd:
    case Scenario::wind:
    case Scenario::tunnel:
      return WorldSet::reporting;
  }
  throw std::invalid_argument("unknown scenario number " + std::to_string(static_cast<int>(scenario)));
}

WorldSet setOfSeed(std::uint64_t seed) {
  return seed < kFirstReportingSeed ? WorldSet::tuning : WorldSet::reporting;
}

std::optional<WorldSet> setOf(const world::WorldSettings& world) {
  const WorldSet set = setOf(world.scenario);
  return set == setOfSeed(world.seed) ? std::optional(set) : std::nullopt;
}

std::vector<world::WorldSettings> drivesOf(WorldSet set) {
  std::vector<world::WorldSettings> drives;
  const auto add = [&](Scenario scenario, double liveliness) {
    if (setOf(scenario) != set) return;
    drives.emplace_back().scenario = scenario;
    drives.back().liveliness = liveliness;
  };
  for (const Scenario scenario : world::allScenarios())
    add(scenario, 0.0);
  for (const Scenario scenario : kLivelyScenarios)
    add(scenario, 1.0);
  return drives;
}

std::uint64_t defaultSeed(WorldSet set) {
  return set == WorldSet::tuning ? 1 : kFirstReportingSeed + 1;
}

}  // namespace cartvo::benchmark
