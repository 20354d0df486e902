// `cartvo benchmark speed`: what is made of times, and a tiny run.
#include <numeric>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"
#include "tools/benchmark/silent.hpp"
#include "tools/benchmark/speed_benchmark.hpp"
#include "tools/benchmark/speed_report.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::HasSubstr;

TEST(Distribution, IsOfNearestRanks) {
  std::vector<double> times(200);
  std::iota(times.begin(), times.end(), 1.0);
  const Distribution distribution = distributionOf(times);
  EXPECT_DOUBLE_EQ(distribution.median, 100.0);
  EXPECT_DOUBLE_EQ(distribution.p99, 198.0);
  EXPECT_DOUBLE_EQ(distribution.maximum, 200.0);
}

TEST(Growth, IsTheExponent) {
  EXPECT_NEAR(growthExponent({1.0, 10.0, 100.0}, {2.0, 20.0, 200.0}), 1.0, 1e-12);
  EXPECT_NEAR(growthExponent({500.0, 2000.0}, {3.0, 6.0}), 0.5, 1e-12);
}

TEST(ReferenceWork, NeedsATexture) {
  const cv::Mat blank = cv::Mat::zeros(200, 300, CV_8UC1);
  EXPECT_THROW(ReferenceWork(blank, blank), std::invalid_argument);
}

TEST(SpeedBenchmark, RefusesWhatLeavesNothingToTime) {
  SpeedSettings settings;
  settings.sizes = {{340, 210}};
  settings.features = {200};
  EXPECT_THROW(runSpeedBenchmark(settings, test::silent()), std::invalid_argument) << "no threads";
  settings.threads = {1};
  settings.pairs = kWarmUp + 1;
  EXPECT_THROW(runSpeedBenchmark(settings, test::silent()), std::invalid_argument) << "too few pairs";
}

TEST(SpeedBenchmark, TimesEachSizeWithEachNumberOfFeatures) {
  const test::TemporaryFolder cache;
  SpeedSettings settings;
  settings.sizes = {{340, 210}};
  settings.features = {100, 300};
  settings.threads = {1};
  settings.pairs = kWarmUp + 2;
  settings.repeats = 2;
  settings.cache = cache.path();
  const std::vector<SpeedResult> results = runSpeedBenchmark(settings, test::silent());
  ASSERT_EQ(results.size(), 2u);
  for (const SpeedResult& result : results) {
    EXPECT_EQ(result.size, settings.sizes[0]);
    EXPECT_EQ(result.pairs, 4u) << "but for those of the warm-up";
    EXPECT_GT(result.rectified.median, 0.0);
    EXPECT_GT(result.raw.median, result.rectified.median) << "the lens is rectified";
    EXPECT_GT(result.stage(Stage::rectify), 0.0);
    EXPECT_GT(result.reference.klt, 0.0);
    EXPECT_GT(result.reference.remap, 0.0);
    EXPECT_GT(result.used, 30.0) << "the odometry works";
  }
  EXPECT_GT(results[1].used, results[0].used);

  const std::string text = speedTables(results, ReportFormat::text);
  EXPECT_THAT(text, HasSubstr("340x210"));
  EXPECT_THAT(text, HasSubstr("over features"));
  const nlohmann::ordered_json json = speedJson(results);
  ASSERT_EQ(json["speeds"].size(), 2u);
  EXPECT_EQ(json["speeds"][1]["features"], 300);
  EXPECT_GT(json["speeds"][0]["rectified_ratio"], 0.0);
}

}  // namespace
}  // namespace cartvo::benchmark
