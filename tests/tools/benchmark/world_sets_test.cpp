// Verifies that the worlds which choose a number and those which report it share nothing.
#include "tools/benchmark/world_sets.hpp"

#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo::benchmark {
namespace {

using world::Scenario;

world::WorldSettings worldOf(Scenario scenario, std::uint64_t seed) {
  world::WorldSettings settings;
  settings.scenario = scenario;
  settings.seed = seed;
  return settings;
}

std::set<Scenario> scenariosOf(WorldSet set) {
  std::set<Scenario> scenarios;
  for (const world::WorldSettings& drive : drivesOf(set))
    scenarios.insert(drive.scenario);
  return scenarios;
}

TEST(WorldSets, ShareNoScenario) {
  const std::set<Scenario> tuning = scenariosOf(WorldSet::tuning);
  const std::set<Scenario> reporting = scenariosOf(WorldSet::reporting);
  EXPECT_GE(tuning.size(), 16U);
  EXPECT_GE(reporting.size(), 9U);
  EXPECT_EQ(tuning.size() + reporting.size(), world::allScenarios().size());
  std::set<Scenario> both = tuning;
  both.insert(reporting.begin(), reporting.end());
  EXPECT_EQ(both.size(), world::allScenarios().size());
}

TEST(WorldSets, HaveLivelyDrives) {
  for (const WorldSet set : {WorldSet::tuning, WorldSet::reporting}) {
    std::set<std::string> names;
    int lively = 0;
    const std::vector<world::WorldSettings> drives = drivesOf(set);
    for (const world::WorldSettings& drive : drives) {
      names.insert(world::driveName(drive));
      if (drive.liveliness == 1.0) ++lively;
    }
    EXPECT_EQ(names.size(), drives.size()) << "a drive is listed twice";
    EXPECT_EQ(lively, 5);
  }
}

TEST(WorldSets, ShareNoSeed) {
  for (const WorldSet set : {WorldSet::tuning, WorldSet::reporting})
    EXPECT_EQ(setOfSeed(defaultSeed(set)), set);
  for (const std::uint64_t seed : {1, 2, 3, 7, 9})
    EXPECT_EQ(setOfSeed(seed), WorldSet::tuning);
  EXPECT_EQ(setOfSeed(10), WorldSet::reporting);
}

TEST(WorldSets, AWorldNeedsScenarioAndSeedOfOneSet) {
  EXPECT_EQ(setOf(worldOf(Scenario::campus, 1)), WorldSet::tuning);
  EXPECT_EQ(setOf(worldOf(Scenario::rain, 11)), WorldSet::reporting);
  EXPECT_FALSE(setOf(worldOf(Scenario::campus, 11)));
  EXPECT_FALSE(setOf(worldOf(Scenario::rain, 1)));
}

TEST(WorldSets, NamesAreReadBack) {
  for (const WorldSet set : {WorldSet::tuning, WorldSet::reporting})
    EXPECT_EQ(worldSetNamed(worldSetName(set)), set);
  EXPECT_THROW(worldSetNamed("both"), std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::benchmark
