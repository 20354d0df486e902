// Depth error and overlap of planned stereo rigs, and `cartvo calibrate plan`.
#include <cmath>
#include <filesystem>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/calibrate/plan/plan_report.hpp"
#include "tools/calibrate/plan/stereo_design.hpp"

namespace cartvo::calibrate {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const StereoDesign kCart{0.115, 480.0, 680.0};

TEST(StereoDesign, DepthErrorAgreesWithTriangulation) {
  const double range = 10.0, noise = 0.01;
  const double wrong = kCart.focal_length * kCart.baseline / (disparityAt(kCart, range) - noise);
  EXPECT_NEAR(depthError(kCart, noise, range), wrong - range, 0.002 * (wrong - range));
  const double good_to = rangeOfRelativeError(kCart, noise, 0.05);
  EXPECT_NEAR(depthError(kCart, noise, good_to), 0.05 * good_to, 1e-9);
}

/// Counts, of points spread over the left camera's view at a range, those that the right one sees.
TEST(StereoDesign, OverlapIsTheShareOfTheViewSeenByBoth) {
  for (const double range : {0.1, 0.5, 2.0, 40.0}) {
    int seen_by_right = 0;
    constexpr int kPoints = 100000;
    for (int i = 0; i < kPoints; ++i) {
      const double x_left = kCart.image_width * (i + 0.5) / kPoints;
      const double x = (x_left - kCart.image_width / 2.0) / kCart.focal_length * range;
      const double x_right = kCart.focal_length * (x - kCart.baseline) / range + kCart.image_width / 2.0;
      if (x_right >= 0.0 && x_right <= kCart.image_width) ++seen_by_right;
    }
    EXPECT_NEAR(overlapAt(kCart, range), static_cast<double>(seen_by_right) / kPoints, 2e-5) << range;
  }
}

TEST(StereoDesign, FocalLengthFollowsFromLensAndFromAngleOfView) {
  EXPECT_NEAR(focalLengthOfLens(4.0, 5.0, 1000.0), 800.0, 1e-9);
  const double focal_length = focalLengthOfView(std::numbers::pi / 2.0, 1000.0);
  EXPECT_NEAR(focal_length, 500.0, 1e-9);
  EXPECT_NEAR(horizontalView({0.1, focal_length, 1000.0}), std::numbers::pi / 2.0, 1e-12);
}

TEST(CalibratePlanCommand, ReportsEachCombinationInEachFormat) {
  const test::TemporaryFolder folder;
  const std::string plot = folder / "plan.svg";
  const std::string arguments =
      "calibrate plan --baseline 0.115,0.3 --width 680,1280 --focal-mm 4 --sensor-width 5.6 --ranges 5,20 ";
  const test::CommandResult json = test::runCartvo(arguments + "--json --plot " + plot);
  ASSERT_EQ(json.exit_code, 0) << json.output;
  const auto plan = nlohmann::json::parse(json.output);
  ASSERT_EQ(plan["designs"].size(), 4u);
  EXPECT_NEAR(plan["designs"][3]["focal_length_px"].get<double>(), 1280.0 * 4.0 / 5.6, 1e-9);
  EXPECT_NEAR(plan["designs"][3]["ranges"][1]["depth_error_m"].get<double>(),
              400.0 * 0.2 / (0.3 * 1280.0 * 4.0 / 5.6), 1e-9);
  EXPECT_TRUE(std::filesystem::exists(plot));
  const std::string table = test::runCartvo(arguments).output;
  EXPECT_THAT(table, HasSubstr("error at 20 m (m)"));
  EXPECT_THAT(table, HasSubstr("overlap at 20 m (%)"));
  EXPECT_LE(table.find("\n"), 80U) << "four designs on a narrow screen";
  EXPECT_THAT(test::runCartvo(arguments + "--format markdown").output, HasSubstr("| baseline (m) "));
}

TEST(CalibratePlanCommand, IncludesARig) {
  const test::TemporaryFolder folder;
  calib::writeRig(folder / "rig.yaml", test::rectifiedRig());
  const test::CommandResult run =
      test::runCartvo("calibrate plan --json --rig " + (folder / "rig.yaml").string());
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto plan = nlohmann::json::parse(run.output);
  ASSERT_EQ(plan["designs"].size(), 1u);
  EXPECT_EQ(plan["designs"][0]["baseline_m"], 0.12);
  EXPECT_EQ(plan["designs"][0]["focal_length_px"], 500.5);
}

TEST(CalibratePlanCommand, RequiresALens) {
  const test::CommandResult none = test::runCartvo("calibrate plan");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.output, HasSubstr("one of --hfov, --focal-mm with --sensor-width, --focal-px and --rig"));
  EXPECT_EQ(test::runCartvo("calibrate plan --focal-mm 4").exit_code, 2);
}

}  // namespace
}  // namespace cartvo::calibrate
