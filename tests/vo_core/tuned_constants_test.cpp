// Tests of the lists of tuned constants.
#include "vo_core/tuned_constants.hpp"

#include <cmath>
#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "vo_core/fixed_constants.hpp"
#include "vo_core/odometry_settings.hpp"

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

std::string errorOf(const std::function<void(OdometrySettings&)>& change) {
  OdometrySettings settings;
  change(settings);
  try {
    validate(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(OdometrySettings, AcceptsDefaults) {
  EXPECT_NO_THROW(validate(OdometrySettings{}));
}

TEST(OdometrySettings, ErrorNamesTheValueAndItsRange) {
  EXPECT_EQ(errorOf([](OdometrySettings& s) { s.features = 3; }), "features is 3: expected 50 to 20000");
  EXPECT_EQ(errorOf([](OdometrySettings& s) { s.tracking.levels = 0; }),
            "tracking.levels is 0: expected 1 to 8");
  EXPECT_EQ(errorOf([](OdometrySettings& s) { s.detection.maximum_threshold = 2; }),
            "detection.maximum_threshold is 2: expected 6 to 254");
  EXPECT_EQ(errorOf([](OdometrySettings& s) { s.stereo.rows = 4; }), "stereo.rows is 4: expected 0 to 3");
  EXPECT_EQ(errorOf([](OdometrySettings& s) { s.motion.subset_size = 2; }),
            "motion.subset_size is 2: expected 3 to 100");
  EXPECT_EQ(errorOf([](OdometrySettings& s) { s.window.pairs = 8; }), "window.pairs is 8: expected 2 to 7");
  EXPECT_EQ(errorOf([](OdometrySettings& s) { s.refinement.frames = 9; }),
            "refinement.frames is 9: expected 1 to 8");
  EXPECT_EQ(errorOf([](OdometrySettings& s) { s.validity.maximum_speed = std::nan(""); }),
            "validity.maximum_speed is nan: expected 0.1 to 1000");
}

}  // namespace

}  // namespace cartvo::vo
