// Tests of the lists of tuned constants.
#include "vo_core/tuned_constants.hpp"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "vo_core/fixed_constants.hpp"

namespace cartvo::vo {
namespace {

/// Tuned constants and limits.
std::vector<TunedConstant> all() {
  std::vector<TunedConstant> both(tunedConstants().begin(), tunedConstants().end());
  both.insert(both.end(), productLimits().begin(), productLimits().end());
  return both;
}

TEST(TunedConstants, HaveDistinctNamesAndSources) {
  std::set<std::string> names;
  for (const TunedConstant& constant : all()) {
    EXPECT_TRUE(names.insert(constant.name).second) << constant.name;
    EXPECT_GT(std::string(constant.source).size(), 5u) << constant.name;
  }
}

TEST(TunedConstants, HaveDefaultsWithinTheirRanges) {
  for (const TunedConstant& constant : all()) {
    const double value = constant.value({});
    EXPECT_GE(value, constant.low) << constant.name;
    EXPECT_LE(value, constant.high) << constant.name;
    EXPECT_LT(constant.low, constant.high) << constant.name;
  }
}

TEST(TunedConstants, AreSetOneAtATime) {
  for (const TunedConstant& constant : all()) {
    OdometrySettings settings;
    constant.set(constant.low, settings);
    for (const TunedConstant& other : all()) {
      const double expected = other.member == constant.member ? constant.low : other.value({});
      EXPECT_EQ(other.value(settings), expected) << constant.name << " changed " << other.name;
    }
  }
}

TEST(TunedConstants, AreValidated) {
  for (const TunedConstant& constant : all()) {
    OdometrySettings settings;
    constant.set(constant.low - 1.0, settings);
    EXPECT_THROW(validate(settings), std::invalid_argument) << constant.name;
  }
}

TEST(FixedConstants, HaveDistinctNamesAndSources) {
  std::set<std::string> names;
  for (const FixedConstant& constant : kFixedConstants) {
    EXPECT_TRUE(names.insert(constant.name).second) << constant.name;
    EXPECT_GT(std::string(constant.source).size(), 5u) << constant.name;
    EXPECT_GT(constant.value, 0.0) << constant.name;
  }
}

// Both numbers may only fall: a new constant takes the place of another one.
TEST(TunedConstants, DoNotBecomeMore) {
  EXPECT_LE(tunedConstants().size(), 51u);
  EXPECT_LE(kFixedConstants.size(), 56u);
}

}  // namespace
}  // namespace cartvo::vo
