// Tests of the validation of settings.
#include "vo_core/odometry_settings.hpp"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

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
