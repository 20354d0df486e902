// Tests of the self-check of a whole drive.
#include "tools/replay/drive_self_check.hpp"

#include <string>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

constexpr double kPeriod = 0.05;  // s

TEST(DriveSelfCheck, NamesAFaultThatHasEnded) {
  DriveSelfCheck check;
  for (int i = 0; i < 200; ++i)
    check.add(i >= 40 && i < 100 ? "turned by " + std::to_string(0.01 * i) + " deg" : "", kPeriod * i);
  EXPECT_EQ(check.sentence(), "turned by 0.990000 deg (from 2.0 to 5.0 s)");
}

TEST(DriveSelfCheck, NamesTheLongestFirstAndNoMoment) {
  DriveSelfCheck check;
  for (int i = 0; i < 200; ++i)
    check.add(i < 10 ? "moment" : i < 60 ? "short" : "long", kPeriod * i);
  EXPECT_EQ(check.sentence(), "long; short (from 0.5 to 3.0 s)");
}

TEST(DriveSelfCheck, SaysNothingOfAGoodDrive) {
  DriveSelfCheck check;
  EXPECT_EQ(check.sentence(), "");
  check.add("", 0.0);
  EXPECT_EQ(check.sentence(), "");
}

}  // namespace
}  // namespace cartvo
