// Tests of the shutter benchmark: cases, runs, rates, ratios, tables and plot.
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/pipeline/alert_limits.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "support/tools/silent.hpp"
#include "support/tools/tiny_world.hpp"
#include "tools/benchmark/shutter/shutter_benchmark.hpp"
#include "tools/benchmark/shutter/shutter_plot.hpp"
#include "tools/benchmark/shutter/shutter_report.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const StereoReadout kDown{0.032, 0.032}, kUp{-0.032, -0.032};

TEST(ReadoutModelNames, AreParsedBack) {
  for (const std::string& name : readoutModelNames())
    EXPECT_EQ(readoutModelName(readoutModelNamed(name)), name);
  EXPECT_THROW(readoutModelNamed("guess"), std::invalid_argument);
}

TEST(ShutterCases, LeaveOutModelsThatCannotDiffer) {
  EXPECT_TRUE(isMeasured({}, ReadoutModel::known));
  EXPECT_FALSE(isMeasured({}, ReadoutModel::ignored)) << "a global shutter is known";
  EXPECT_TRUE(isMeasured({kDown, {}, {}}, ReadoutModel::estimated));
  EXPECT_FALSE(isMeasured({kUp, {}, {}}, ReadoutModel::estimated)) << "the estimate begins with 32 ms";
  EXPECT_TRUE(isMeasured({kUp, {}, {}}, ReadoutModel::ignored));
}

TEST(ShutterBenchmark, MeasuresEachWorldInEachCaseWithEachModel) {
  const test::TemporaryFolder cache;
  ShutterSettings settings;
  settings.worlds = {test::tinyWorld()};
  settings.cases = {{}, {kDown, {0.025, 0.0}, {8.0, 0.005}}};
  settings.models = {ReadoutModel::known, ReadoutModel::ignored};
  settings.odometry.features = 400;
  settings.cache = cache.path();
  settings.limits = test::kNoAlertLimits;
  const std::vector<ShutterAccuracy> accuracies = runShutterBenchmark(settings, test::silent());
  ASSERT_EQ(accuracies.size(), 3u);
  for (const ShutterAccuracy& one : accuracies) {
    EXPECT_EQ(one.sequence, "campus");
    EXPECT_EQ(one.accuracy.pairs, 6u);
    EXPECT_GT(one.rates.count(), 0u);
  }
  EXPECT_TRUE(accuracies[0].seen.readout.isGlobal());
  EXPECT_EQ(accuracies[1].seen, settings.cases[1]);
  EXPECT_EQ(accuracies[1].model, ReadoutModel::known);
  EXPECT_EQ(accuracies[2].model, ReadoutModel::ignored);
}

Replay turning(double rate) {
  Replay replay;
  for (int index = 0; index < 4; ++index) {
    ReplayedPair pair;
    pair.exposure_ns = index;
    pair.valid = index > 0;
    pair.angular_velocity = {0.0, 0.0, rate};
    replay.pairs.push_back(pair);
  }
  return replay;
}

SequenceTruth turningTruth(double rate) {
  SequenceTruth truth;
  for (int index = 0; index < 4; ++index) {
    truth.left_camera.push_back({index, Eigen::Isometry3d::Identity()});
    truth.body_twist.emplace_back(rate * vo::Vector6d::Unit(5));
  }
  return truth;
}

TEST(AngularRateErrors, AreRelativeToTheTrueRatesOfValidPairs) {
  AngularRateErrors errors(turning(0.9), turningTruth(1.0));
  EXPECT_EQ(errors.count(), 3u);
  EXPECT_NEAR(errors.relative(), 0.1, 1e-12);
  errors.add(AngularRateErrors(turning(2.0), turningTruth(2.0)));
  EXPECT_NEAR(errors.relative(), std::sqrt(0.03 / 15.0), 1e-12) << "squares are pooled";
}

ShutterAccuracy example(const std::string& sequence, const ShutterCase& seen, ReadoutModel model,
                        double translation) {
  ShutterAccuracy one{sequence, seen, model, {}, AngularRateErrors(turning(0.9), turningTruth(1.0))};
  one.accuracy.sequence = sequence;
  one.accuracy.kind = SequenceKind::rendered;
  one.accuracy.pairs = 101;
  one.accuracy.validity = {100, 98, 97, 1, 2, 0.5, 0.4, 0.03};
  one.accuracy.evaluation.poses = 101;
  one.accuracy.evaluation.short_segments.all = {0.0, 50, translation, 1e-4};
  one.accuracy.evaluation.relative_translation = 0.5 * translation;
  one.accuracy.evaluation.relative_rotation = 1e-5;
  one.accuracy.consistency.velocity = NormalisedErrors({{125.0, 100}}, 0);
  return one;
}

/// Two worlds with a global and a rolling shutter, and with two vibrations. Known, the readout costs a fifth;
/// ignored, the errors are thirty times larger.
std::vector<ShutterAccuracy> examples() {
  std::vector<ShutterAccuracy> all;
  for (const char* world : {"campus", "turns"}) {
    all.push_back(example(world, {}, ReadoutModel::known, 0.001));
    all.push_back(example(world, {kDown, {}, {}}, ReadoutModel::known, 0.0012));
    all.push_back(example(world, {kDown, {}, {}}, ReadoutModel::ignored, 0.03));
    for (const double frequency : {5.0, 8.0})
      all.push_back(example(world, {{0.032, 0.038}, {}, {frequency, 0.005}}, ReadoutModel::known, 0.002));
  }
  return all;
}

TEST(ShutterTable, HasRatiosToAGlobalShutter) {
  const std::string table = shutterTable(examples(), ReportFormat::text);
  EXPECT_THAT(table, HasSubstr("30.00 / 1.00"));
  EXPECT_THAT(table, HasSubstr("1.20 / 1.00"));
  EXPECT_THAT(table, HasSubstr("32 / 38 ms"));
  EXPECT_THAT(table, HasSubstr("8 Hz, 0.286 deg"));
  EXPECT_THAT(table, HasSubstr("98.0"));
  EXPECT_THAT(table, HasSubstr("readout known: 8 of 776 VALID messages above an alert limit"));
  EXPECT_THAT(table, HasSubstr("all 2 worlds"));
  EXPECT_THAT(shutterTable(examples(), ReportFormat::markdown), ::testing::StartsWith("| sequence"));
}

TEST(ShutterTable, HasNoRatioWithoutAGlobalShutterOfTheSameDrive) {
  const std::vector<ShutterAccuracy> all = examples();
  EXPECT_TRUE(ratiosToGlobal(all[1], all).has_value());
  EXPECT_FALSE(ratiosToGlobal(all[3], all).has_value()) << "the global shutter was not shaken";
  EXPECT_FALSE(ratiosToGlobal(all[1], {all[1]}).has_value());
}

TEST(ShutterJson, HasOneRowPerResultAndSummary) {
  const nlohmann::ordered_json json = shutterJson(examples());
  ASSERT_EQ(json["shutters"].size(), 15u) << "ten results and five summaries of both worlds";
  const auto& ignored = json["shutters"][2];
  EXPECT_EQ(ignored["model"], "ignored");
  EXPECT_DOUBLE_EQ(ignored["left_readout_ms"], 32.0);
  EXPECT_NEAR(ignored["ratio_to_global"]["segment_translation"], 30.0, 1e-9);
  EXPECT_NEAR(ignored["relative_rate_error"], 0.1, 1e-9);
  EXPECT_NEAR(ignored["available_percent"], 98.0, 1e-9);
  EXPECT_TRUE(ignored["nees_motion"].is_null());
  EXPECT_NEAR(ignored["nees_velocity"], 1.25, 1e-12);
}

TEST(ShutterPlot, DrawsReadoutsAndVibrations) {
  const std::string svg = shutterPlot(examples()).svg();
  EXPECT_THAT(svg, ::testing::StartsWith("<svg"));
  EXPECT_THAT(svg, HasSubstr("readout (ms)"));
  EXPECT_THAT(svg, HasSubstr("frequency (Hz)"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THROW(shutterPlot({examples().front()}), std::invalid_argument);
}

TEST(ShutterCommand, RejectsValuesOutOfRange) {
  const test::CommandResult readout = test::runCartvo("benchmark shutter --readouts-ms 0,32/x");
  EXPECT_NE(readout.exit_code, 0);
  EXPECT_THAT(readout.output, HasSubstr("is not the readout of both cameras"));
  const test::CommandResult none = test::runCartvo("benchmark shutter --scenarios none");
  EXPECT_NE(none.exit_code, 0);
  EXPECT_THAT(none.output, HasSubstr("--scenarios"));
}

}  // namespace
}  // namespace cartvo::benchmark
