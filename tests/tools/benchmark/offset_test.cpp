// Tests of the offset benchmark: clocks, runs, ratios, tables and plot.
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "support/pipeline/alert_limits.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/silent.hpp"
#include "support/tools/tiny_world.hpp"
#include "tools/benchmark/offset/alternate_frames.hpp"
#include "tools/benchmark/offset/offset_benchmark.hpp"
#include "tools/benchmark/offset/offset_plot.hpp"
#include "tools/benchmark/offset/offset_report.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

world::WorldSettings twentySecondsAtTwentyHertz() {
  world::WorldSettings world;
  world.seconds = 20.0;
  world.frame_rate = 20.0;
  return world;
}

TEST(RightClock, SlowSweepCrossesHalfAPeriodAtCrystalDrift) {
  const RightClock slow = slowSweep(twentySecondsAtTwentyHertz());
  EXPECT_DOUBLE_EQ(slow.drift_ppm, 50.0);
  EXPECT_NEAR(slow.offset_s + 10.0 * 50e-6, 0.025, 1e-12) << "in the middle of the drive";
}

TEST(RightClock, FastSweepCoversAllOffsetsWithinTheDrive) {
  const RightClock fast = fastSweep(twentySecondsAtTwentyHertz());
  EXPECT_LT(fast.offset_s, 0.0);
  EXPECT_NEAR(fast.offset_s + 5.0 * 1e-6 * fast.drift_ppm, 0.0, 1e-12) << "through zero";
  EXPECT_NEAR(fast.offset_s + 15.0 * 1e-6 * fast.drift_ppm, 0.025, 1e-12) << "through half a period";
}

TEST(OffsetModelNames, AreParsedBack) {
  for (const std::string& name : offsetModelNames())
    EXPECT_EQ(offsetModelName(offsetModelNamed(name)), name);
  EXPECT_THROW(offsetModelNamed("guess"), std::invalid_argument);
}

TEST(AlternateFrames, AreEverySecondImageOfEachCamera) {
  CARTVO_NEEDS_DATA(folder, "kitti_06");
  const capture::ImageFolder all = capture::readImageFolder(folder);
  for (const RightFrames right : {RightFrames::same, RightFrames::next}) {
    capture::StereoSource source = openAlternate(folder, right, false);
    const std::size_t first = right == RightFrames::next ? 1 : 0;
    ASSERT_EQ(source.pairs, right == RightFrames::next ? 25u : 26u);
    capture::Frame left_frame, right_frame;
    for (std::size_t i = 0; i < source.pairs; ++i) {
      ASSERT_EQ(source.left->read(left_frame, {}), capture::ReadOutcome::frame);
      ASSERT_EQ(source.right->read(right_frame, {}), capture::ReadOutcome::frame);
      EXPECT_EQ(left_frame.exposure_ns, all.left.instants_ns[2 * i]);
      EXPECT_EQ(right_frame.exposure_ns, all.right.instants_ns[2 * i + first]);
      EXPECT_GT(source.period_ns / 2, right_frame.exposure_ns - left_frame.exposure_ns)
          << "the frames must be within the pairing window";
    }
  }
}

TEST(AlternateFrames, KeepTheirPairsWhenPlayedSimultaneously) {
  CARTVO_NEEDS_DATA(folder, "kitti_06");
  const capture::ImageFolder all = capture::readImageFolder(folder);
  capture::StereoSource source = openAlternate(folder, RightFrames::next, true);
  ASSERT_EQ(source.pairs, 25u);
  capture::Frame left_frame, right_frame;
  for (std::size_t i = 0; i < source.pairs; ++i) {
    ASSERT_EQ(source.left->read(left_frame, {}), capture::ReadOutcome::frame);
    ASSERT_EQ(source.right->read(right_frame, {}), capture::ReadOutcome::frame);
    EXPECT_EQ(left_frame.exposure_ns, all.left.instants_ns[2 * i]);
    EXPECT_EQ(right_frame.exposure_ns, left_frame.exposure_ns);
    EXPECT_EQ(cv::norm(right_frame.image, capture::readGreyImage(all.right.images[2 * i + 1]), cv::NORM_INF),
              0.0);
  }
}

TEST(OffsetBenchmark, MeasuresEachWorldWithEachClockAndModel) {
  const test::TemporaryFolder cache;
  OffsetSettings settings;
  settings.worlds = {test::tinyWorld()};
  settings.clocks = {RightClock{}, RightClock{0.04, 0.0}};
  settings.models = {OffsetModel::two_instants, OffsetModel::simultaneous};
  settings.odometry.features = 400;
  settings.cache = cache.path();
  settings.limits = test::kNoAlertLimits;
  const std::vector<OffsetAccuracy> accuracies = runOffsetBenchmark(settings, test::silent());
  ASSERT_EQ(accuracies.size(), 4u);
  for (const OffsetAccuracy& one : accuracies) {
    EXPECT_EQ(one.sequence, "campus");
    EXPECT_EQ(one.accuracy.pairs, 6u);
  }
  EXPECT_EQ(accuracies[0].accuracy.evaluation.relative_translation,
            accuracies[1].accuracy.evaluation.relative_translation)
      << "without a time offset the models are the same";
  EXPECT_EQ(accuracies[2].clock, settings.clocks[1]);
  EXPECT_EQ(accuracies[3].model, OffsetModel::simultaneous);
  EXPECT_NE(accuracies[2].accuracy.evaluation.relative_translation,
            accuracies[3].accuracy.evaluation.relative_translation);
}

OffsetAccuracy example(const std::string& sequence, const RightClock& clock, OffsetModel model,
                       double translation) {
  OffsetAccuracy one{sequence, clock, model, {}};
  one.accuracy.sequence = sequence;
  one.accuracy.kind = SequenceKind::rendered;
  one.accuracy.pairs = 100;
  one.accuracy.evaluation.poses = 100;
  one.accuracy.evaluation.short_segments.all = {0.0, 50, translation, 1e-4};
  one.accuracy.evaluation.relative_translation = 0.5 * translation;
  one.accuracy.evaluation.relative_rotation = 1e-5;
  return one;
}

/// Two worlds, each with offsets of 0 and 25 ms and with a drifting clock. At 25 ms two-instants is as
/// accurate as at 0 ms, simultaneous ten times worse.
std::vector<OffsetAccuracy> examples() {
  std::vector<OffsetAccuracy> all;
  for (const char* world : {"campus", "turns"}) {
    all.push_back(example(world, {}, OffsetModel::two_instants, 0.001));
    all.push_back(example(world, {0.025, 0.0}, OffsetModel::two_instants, 0.0012));
    all.push_back(example(world, {0.025, 0.0}, OffsetModel::simultaneous, 0.0123));
    all.push_back(example(world, {-0.01, 5000.0}, OffsetModel::two_instants, 0.7));
  }
  return all;
}

TEST(OffsetTable, HasRatiosToSynchronisedCameras) {
  const std::string table = offsetTable(examples(), ReportFormat::text);
  EXPECT_THAT(table, HasSubstr("1.23 / 0.00573"));
  EXPECT_THAT(table, HasSubstr("12.30 / 1.00"));
  EXPECT_THAT(table, HasSubstr("-10 ms +5000 ppm"));
  EXPECT_THAT(table, HasSubstr("all 2 worlds"));
  EXPECT_THAT(offsetTable(examples(), ReportFormat::markdown), ::testing::StartsWith("| sequence"));
}

TEST(OffsetTable, HasNoRatioWithoutAReference) {
  const std::vector<OffsetAccuracy> alone{example("campus", {0.025, 0.0}, OffsetModel::two_instants, 0.001)};
  EXPECT_FALSE(ratiosOf(alone[0], alone).has_value());
  EXPECT_THAT(offsetTable(alone, ReportFormat::text), Not(HasSubstr("all 1 worlds")));
}

TEST(OffsetJson, HasOneRowPerResultAndSummary) {
  const nlohmann::ordered_json json = offsetJson(examples());
  ASSERT_EQ(json["offsets"].size(), 12u) << "eight results and four summaries of both worlds";
  const auto& late = json["offsets"][2];
  EXPECT_EQ(late["model"], "simultaneous");
  EXPECT_DOUBLE_EQ(late["offset_ms"], 25.0);
  EXPECT_NEAR(late["ratio_to_0_ms"]["segment_translation"], 12.3, 1e-9);
  EXPECT_TRUE(late["nees_motion"].is_null());
}

TEST(OffsetPlot, HasOneCurvePerWorldAndModelAndOnePerSummary) {
  const std::string svg = offsetPlot(examples()).svg();
  EXPECT_THAT(svg, ::testing::StartsWith("<svg"));
  EXPECT_THAT(svg, ::testing::EndsWith("</svg>\n"));
  EXPECT_THAT(svg, HasSubstr("two-instants"));
  EXPECT_THAT(svg, HasSubstr("simultaneous"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  std::size_t curves = 0;
  for (std::size_t at = 0; (at = svg.find("stroke-opacity", at)) != std::string::npos; ++at)
    ++curves;
  EXPECT_EQ(curves, 8u) << "two diagrams, each of two worlds with two models";
  EXPECT_THROW(offsetPlot({example("campus", {0.0, 50.0}, OffsetModel::two_instants, 0.1)}),
               std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::benchmark
