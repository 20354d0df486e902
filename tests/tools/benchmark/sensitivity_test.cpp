// Tests of the sensitivity benchmark: changed settings, comparison, run and report.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/lab/tiny_world.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/silent.hpp"
#include "tools/benchmark/sensitivity/sensitivity_benchmark.hpp"
#include "tools/benchmark/sensitivity/sensitivity_report.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::HasSubstr;

const vo::TunedConstant& constantNamed(const std::string& name) {
  for (const vo::TunedConstant& constant : vo::tunedConstants())
    if (name == constant.name) return constant;
  throw std::invalid_argument(name);
}

TEST(Sensitivity, ChangesOneConstant) {
  const vo::OdometrySettings settings;
  const auto changed = withConstant(constantNamed("bundle.robust_width"), 2.0, settings);
  ASSERT_TRUE(changed);
  EXPECT_EQ(changed->bundle.robust_width, 2.0);
  EXPECT_EQ(changed->bundle.frames, settings.bundle.frames);
}

TEST(Sensitivity, MovesAnIntegerByAtLeastOne) {
  const vo::OdometrySettings settings;
  EXPECT_EQ(withConstant(constantNamed("bundle.free_frames"), 2.2, settings)->bundle.free_frames, 3);
  EXPECT_EQ(withConstant(constantNamed("bundle.free_frames"), 1.8, settings)->bundle.free_frames, 1);
}

TEST(Sensitivity, StaysWithinTheRange) {
  const vo::OdometrySettings settings;
  EXPECT_FALSE(withConstant(constantNamed("bundle.frames"), 9.1, settings)) << "the default is the largest";
  EXPECT_EQ(withConstant(constantNamed("history.minimum_weight"), 7.0, settings)->history.minimum_weight,
            1.0);
  EXPECT_FALSE(withConstant(constantNamed("detection.maximum_threshold"), 3.0, settings))
      << "below the least threshold";
}

SequenceAccuracy accuracyOf(double errors, std::size_t invalid) {
  SequenceAccuracy accuracy;
  accuracy.evaluation.short_segments.all = {0.0, 10, 0.01 * errors, 0.001 * errors};
  accuracy.evaluation.relative_translation = 0.002 * errors;
  accuracy.evaluation.relative_rotation = 0.0;  // no ratio
  accuracy.invalid = invalid;
  return accuracy;
}

TEST(Sensitivity, ComparesByGeometricMeans) {
  const RelativeResult result =
      relativeTo({accuracyOf(1.0, 2), accuracyOf(2.0, 0)}, {accuracyOf(2.0, 1), accuracyOf(2.0, 3)});
  EXPECT_NEAR(result.segments, 0.5 * std::log(2.0), 1e-12);
  EXPECT_NEAR(result.relative, 0.5 * std::log(2.0), 1e-12);
  EXPECT_EQ(result.nees, 0.0);
  EXPECT_EQ(result.invalid, 2);
}

TEST(Sensitivity, SortsConstantsByTheirEffect) {
  const test::TemporaryFolder folder;
  SensitivitySettings settings;
  settings.sequences.worlds = {test::tinyWorld()};
  settings.sequences.cache = folder.path();
  settings.constants = {"pose_search.gate", "standstill.rotation", "stereo.minimum_correlation"};
  settings.factor = 1e9;
  int last_done = 0, last_total = 0;
  std::string last_unit;
  const WorkObserver observer{[&](const WorkStep& step) { last_unit = step.unit; },
                              [&](int done, int total) {
                                last_done = done;
                                last_total = total;
                              }};
  const Sensitivity sensitivity = runSensitivityBenchmark(settings, observer);
  ASSERT_EQ(sensitivity.constants.size(), 3u);
  for (std::size_t i = 1; i < 3; ++i)
    EXPECT_GE(sensitivity.constants[i - 1].effect, sensitivity.constants[i].effect);
  EXPECT_EQ(last_done, last_total);
  EXPECT_EQ(last_unit, "runs");
  EXPECT_EQ(last_total, 10) << "four runs by chance and two for each constant";
  const std::string table = sensitivityTable(sensitivity, ReportFormat::text);
  EXPECT_THAT(table, HasSubstr("stereo.minimum_correlation"));
  EXPECT_THAT(table, HasSubstr("by chance"));
  EXPECT_EQ(sensitivityJson(sensitivity)["constants"].size(), 3u);
}

TEST(Sensitivity, RejectsUnknownConstants) {
  SensitivitySettings settings;
  settings.constants = {"bundle.magic"};
  EXPECT_THROW(runSensitivityBenchmark(settings, test::silent()), std::invalid_argument);
}

TEST(Sensitivity, ListsAllConstants) {
  const std::string table = constantsTable(ReportFormat::markdown);
  for (const vo::TunedConstant& constant : vo::tunedConstants())
    EXPECT_THAT(table, HasSubstr(std::string("| ") + constant.name + " "));
  EXPECT_EQ(constantsJson()["constants"].size(), vo::tunedConstants().size());
}

TEST(Sensitivity, ListsLimitsApart) {
  EXPECT_THAT(constantsTable(ReportFormat::markdown), HasSubstr("| validity.maximum_speed "));
  EXPECT_EQ(constantsJson()["limits"].size(), vo::productLimits().size());
  EXPECT_THROW(constantNamed("validity.maximum_speed"), std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::benchmark
