// Verifies that the worlds which choose a number and those which report it share nothing.
#include "tools/benchmark/world_sets.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
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

TEST(WorldSets, ShareNoScenario) {
  const std::vector<Scenario> tuning = scenariosOf(WorldSet::tuning);
  const std::vector<Scenario> reporting = scenariosOf(WorldSet::reporting);
  EXPECT_GE(tuning.size(), 16U);
  EXPECT_GE(reporting.size(), 9U);
  EXPECT_EQ(tuning.size() + reporting.size(), world::allScenarios().size());
  std::set<Scenario> both(tuning.begin(), tuning.end());
  both.insert(reporting.begin(), reporting.end());
  EXPECT_EQ(both.size(), world::allScenarios().size());
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
