// Tests of the tables and JSON reports of accuracy and of the thesis benchmark.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/benchmark/accuracy/accuracy_report.hpp"
#include "tools/benchmark/thesis/thesis_report.hpp"
#include "tools/report/table.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Table, AlignsColumnsByCharactersNotBytes) {
  Table table({"name", "µ"});
  table.add({"a", "1.25"});
  table.add({"é", "–"});
  EXPECT_EQ(table.text(),
            "name     µ\n"
            "a     1.25\n"
            "é        –\n");
  EXPECT_EQ(table.markdown(),
            "| name |    µ |\n"
            "| ---- | ---: |\n"
            "| a    | 1.25 |\n"
            "| é    |    – |\n");
}

TEST(Table, RejectsRowWithWrongNumberOfColumns) {
  Table table({"one", "two"});
  EXPECT_THROW(table.add({"1"}), std::invalid_argument);
}

TEST(Table, WritesThreeSignificantDigits) {
  EXPECT_EQ(significant(0.012345), "0.0123");
  EXPECT_EQ(significant(1.2345), "1.23");
  EXPECT_EQ(significant(12.345), "12.3");
  EXPECT_EQ(significant(4110.4), "4110");
  EXPECT_EQ(significant(0.0), "0");
}

/// A world whose motions have this normalised error: 1 is consistent, more is overconfident.
SequenceAccuracy exampleWorld(double normalised_error) {
  SequenceAccuracy world;
  world.sequence = "campus 1";
  world.kind = SequenceKind::rendered;
  world.estimator = "thesis";
  world.pairs = 101;
  world.invalid = 2;
  world.evaluation.poses = 101;
  world.evaluation.path_length = 321.04;
  world.evaluation.final_drift = 1.0;
  world.evaluation.final_drift_fraction = 0.0031;
  world.evaluation.relative_translation = 0.0012;
  world.evaluation.short_segments.all = {0.0, 50, 0.004, 0.0001};
  for (int i = 0; i < 100; ++i) {
    world.consistency.motion.beginGroup();
    world.consistency.motion.add(vo::Vector6d::Constant(std::sqrt(normalised_error)),
                                 vo::Matrix6d::Identity());
  }
  world.times_ms = {10.0, 20.0, 30.0};
  return world;
}

SequenceAccuracy exampleStanding() {
  SequenceAccuracy standing;
  standing.sequence = "euroc_still";
  standing.estimator = "thesis";
  standing.pairs = 40;
  standing.standing = 39;
  standing.standing_speed = 0.0042;
  standing.standing_end = {0.0012, 0.0001};
  standing.evaluation.poses = 40;
  return standing;
}

SequenceAccuracy encodedAt(double bitrate_mbps, double translation) {
  SequenceAccuracy encoded = exampleWorld(1.0);
  encoded.bitrate_mbps = bitrate_mbps;
  encoded.evaluation.short_segments.all.translation = translation;
  return encoded;
}

TEST(AccuracyTable, HasOneRowPerSequenceAndOneForAllWorlds) {
  const std::string table = accuracyTable({exampleStanding(), exampleWorld(1.0)}, ReportFormat::text);
  EXPECT_THAT(table, HasSubstr("\neuroc_still"));
  EXPECT_THAT(table, HasSubstr("\ncampus 1"));
  EXPECT_THAT(table, HasSubstr("\nall 1 worlds"));
  EXPECT_THAT(table, HasSubstr("0.40 / 0.0057"));
  EXPECT_THAT(table, HasSubstr("0.31 / 1.00"));
  EXPECT_THAT(table, HasSubstr("0.12 / 0.006"));
  EXPECT_THAT(table, HasSubstr("1.00 [0.89, 1.12]"));
  EXPECT_THAT(table, HasSubstr("20.0 / 30.0"));
  EXPECT_THAT(table, Not(HasSubstr("Mbit/s")));
}

TEST(AccuracyTable, SummarisesEachSetOnItsOwn) {
  SequenceAccuracy tuning = exampleWorld(1.0);
  tuning.set = WorldSet::tuning;
  SequenceAccuracy worse = tuning;
  worse.sequence = "dusk 1";
  worse.evaluation.short_segments.all.translation = 0.016;
  SequenceAccuracy reporting = exampleWorld(2.0);
  reporting.sequence = "rain 11";
  reporting.set = WorldSet::reporting;
  reporting.validity = {1000, 990, 980, 3, 5, 0.28, 0.41, 0.02};
  const std::string table = accuracyTable({tuning, worse, reporting, exampleStanding()}, ReportFormat::text);
  EXPECT_THAT(table, HasSubstr("\ntuning set, thesis, 2 worlds: 5–40 m: geometric mean 0.800 %, worst 1.60 % "
                               "(dusk 1); NEES motion 1.00 (campus 1) to 1.00 (campus 1); 4 invalid; 0 of 0 "
                               "VALID messages above an "
                               "alert limit"));
  EXPECT_THAT(
      table,
      HasSubstr(
          "\nreporting set, thesis, 1 worlds: 5–40 m: geometric mean 0.400 %, worst 0.400 % "
          "(rain 11); NEES motion 2.00 (rain 11) to 2.00 (rain 11); 2 invalid; 3 of 980 VALID messages above "
          "an alert limit, 5 of 980 above their bound (largest errors 0.41 m/s, 1.15 deg/s); "
          "available: 990 of 1000 messages, 99.00 %, longest gap 0.28 s\n"));
  EXPECT_THAT(table, Not(HasSubstr("neither set,")));
}

TEST(AccuracyTable, KeepsAWorldOfNeitherSetApart) {
  EXPECT_THAT(accuracyTable({exampleWorld(1.0)}, ReportFormat::text),
              HasSubstr("\nneither set, thesis, 1 worlds: "));
}

TEST(AccuracyTable, MarksValuesOutsideTheBand) {
  EXPECT_THAT(accuracyTable({exampleWorld(2.0)}, ReportFormat::text), HasSubstr("2.00* [0.89, 1.12]"));
}

TEST(AccuracyTable, IsWrittenAsMarkdown) {
  EXPECT_THAT(accuracyTable({exampleWorld(1.0)}, ReportFormat::markdown),
              ::testing::AllOf(::testing::StartsWith("| sequence"), HasSubstr("| ------")));
}

TEST(AccuracyTable, ComparesBitRatesWithLosslessImages) {
  const std::vector<SequenceAccuracy> accuracies{exampleWorld(1.0), encodedAt(2.0, 0.006),
                                                 encodedAt(8.0, 0.0038)};
  const std::string table = accuracyTable(accuracies, ReportFormat::text);
  EXPECT_THAT(table, HasSubstr("campus 1, 2 Mbit/s"));
  EXPECT_THAT(table, HasSubstr("0.60 / 0.0057 (+50 %)"));
  EXPECT_THAT(table, HasSubstr("0.38 / 0.0057 (-5 %)"));
  EXPECT_THAT(table, HasSubstr("all 1 worlds")) << "encoded runs are not further worlds";
}

TEST(AccuracyJson, HasUnitsInKeysAndNullForMissingValues) {
  const nlohmann::ordered_json json =
      accuracyJson({exampleStanding(), exampleWorld(1.0), encodedAt(2.0, 0.006)});
  ASSERT_EQ(json["sequences"].size(), 3u);
  const auto& standing = json["sequences"][0];
  const auto& world = json["sequences"][1];
  EXPECT_EQ(standing["kind"], "real");
  EXPECT_TRUE(standing["bitrate_mbps"].is_null());
  EXPECT_TRUE(standing["time_ms"].is_null());
  EXPECT_TRUE(standing["nees_motion"]["mean"].is_null());
  EXPECT_DOUBLE_EQ(standing["standing_end_m"], 0.0012);
  EXPECT_DOUBLE_EQ(standing["standing_highest_speed_m_s"], 0.0042);
  EXPECT_EQ(world["kind"], "rendered");
  EXPECT_EQ(world["sequence"], "campus 1");
  EXPECT_EQ(world["estimator"], "thesis");
  EXPECT_EQ(world["pairs"], 101);
  EXPECT_EQ(world["invalid"], 2);
  EXPECT_EQ(world["lost"], 0);
  EXPECT_EQ(world["resets"], 0);
  EXPECT_EQ(world["above_limit"], 0);
  EXPECT_EQ(world["above_bound"], 0);
  EXPECT_TRUE(world["standing_end_m"].is_null());
  EXPECT_DOUBLE_EQ(world["evaluation"]["segments_5_to_40_m"]["translation_percent"], 0.4);
  EXPECT_NEAR(world["nees_motion"]["mean"], 1.0, 1e-12);
  EXPECT_EQ(world["nees_motion"]["band_95_percent"].size(), 2u);
  EXPECT_EQ(world["nees_motion"]["samples"], 100);
  EXPECT_DOUBLE_EQ(world["time_ms"]["median"], 20.0);
  EXPECT_DOUBLE_EQ(json["sequences"][2]["bitrate_mbps"], 2.0);
  ASSERT_EQ(json["summaries"].size(), 1u);
  EXPECT_EQ(json["summaries"][0]["pairs"], 101);
  EXPECT_TRUE(json["summaries"][0]["evaluation"]["ate_rmse_m"].is_null());
  ASSERT_EQ(json["bitrates"].size(), 1u);
  EXPECT_NEAR(json["bitrates"][0]["segments_5_to_40_m_growth_percent"], 50.0, 1e-9);
}

ThesisResults exampleResults() {
  ThesisResults results;
  results.features = 1000;
  results.many_features = 9600;
  DepthResult depth{"a rig", {}};
  depth.samples.features = 4;
  depth.samples.sub_pixel = {{1.0, 1.0}, {2.0, 2.0}, {3.0, 3.0}};
  depth.samples.whole_pixel = {{1.0, 1.0}, {2.5, 2.0}, {3.0, 3.0}};
  results.depth.push_back(depth);
  StageTimeResult times;
  times.sequence = "kitti_06";
  times.image_size = {1241, 376};
  times.rectification_ms = 4.0;
  times.few.total = 20.0;
  times.many.total = 100.0;
  results.times.push_back(times);
  results.rates.push_back({"kitti_06", vo::Estimator::reprojection, {50, {0.1, 0.2, 0.3}, 0.01, 0.02, 0.03}});
  return results;
}

TEST(ThesisTables, HaveTheThesisValuesAndADashForUnknownOnes) {
  const std::string tables = thesisTables(exampleResults(), ReportFormat::text);
  EXPECT_THAT(tables, HasSubstr("0.9977"));
  EXPECT_THAT(tables, HasSubstr("0.9859"));
  EXPECT_THAT(tables, HasSubstr("+8.6 %"));
  EXPECT_THAT(tables, HasSubstr("+50.0 %"));  // three depths within 10 % instead of two
  EXPECT_THAT(tables, HasSubstr("25.91"));
  EXPECT_THAT(tables, HasSubstr("24.00"));  // with the separately measured rectification
  EXPECT_THAT(tables, ::testing::ContainsRegex("\nthesis +–"));
}

TEST(ThesisJson, HasNullForUnknownThesisValues) {
  const nlohmann::ordered_json json = thesisJson(exampleResults());
  EXPECT_DOUBLE_EQ(json["table_5_1"]["thesis"]["r_squared_sub_pixel"], 0.9977);
  EXPECT_DOUBLE_EQ(json["table_5_1"]["measured"][0]["sub_pixel"]["r_squared"], 1.0);
  EXPECT_DOUBLE_EQ(json["table_5_2"]["thesis"]["stages_ms"]["rectify"], 9.98);
  EXPECT_TRUE(json["tables_5_3_to_5_7"]["thesis"].is_null());
  EXPECT_DOUBLE_EQ(json["tables_5_3_to_5_7"]["measured"][0]["Vz_m_s"], 0.3);
}

}  // namespace
}  // namespace cartvo::benchmark
