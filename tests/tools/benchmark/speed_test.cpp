// Tests of the speed benchmark: statistics, reference work and small runs.
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "calib/rectification/rectifier.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/silent.hpp"
#include "tools/benchmark/speed/drive_in_memory.hpp"
#include "tools/benchmark/speed/speed_benchmark.hpp"
#include "tools/benchmark/speed/speed_report.hpp"

namespace cartvo::benchmark {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(Distribution, UsesNearestRanks) {
  std::vector<double> times(200);
  std::iota(times.begin(), times.end(), 1.0);
  const Distribution distribution = distributionOf(times);
  EXPECT_DOUBLE_EQ(distribution.median, 100.0);
  EXPECT_DOUBLE_EQ(distribution.p99, 198.0);
  EXPECT_DOUBLE_EQ(distribution.maximum, 200.0);
}

TEST(GrowthExponent, IsExactForPowers) {
  EXPECT_NEAR(growthExponent({1.0, 10.0, 100.0}, {2.0, 20.0, 200.0}), 1.0, 1e-12);
  EXPECT_NEAR(growthExponent({500.0, 2000.0}, {3.0, 6.0}), 0.5, 1e-12);
}

TEST(ReferenceWork, RejectsImagesWithoutTexture) {
  const cv::Mat blank = cv::Mat::zeros(200, 300, CV_8UC1);
  EXPECT_THROW(ReferenceWork({blank, blank}), std::invalid_argument);
}

TEST(ReferenceWork, LeavesOutStepsWithoutTexture) {
  cv::Mat grey = cv::Mat::zeros(300, 400, CV_8UC1), noise = grey.clone();
  cv::randu(noise, 0, 255);
  EXPECT_EQ(ReferenceWork({noise, grey, noise, grey}).steps(), 2U);
}

TEST(ReferenceWork, UsesAtMostFiftySteps) {
  cv::Mat noise(300, 400, CV_8UC1);
  cv::randu(noise, 0, 255);
  EXPECT_EQ(ReferenceWork(std::vector<cv::Mat>(60, noise)).steps(), 50U);
}

TEST(ReferenceWork, RejectsFewerThanTwoImages) {
  EXPECT_THROW(ReferenceWork({}), std::invalid_argument);
}

TEST(SpeedBenchmark, RejectsSettingsWithNothingToTime) {
  SpeedSettings settings;
  settings.sizes = {{340, 210}};
  settings.features = {200};
  EXPECT_THROW(runSpeedBenchmark(settings, test::silent()), std::invalid_argument) << "no threads";
  settings.threads = {1};
  settings.pairs = kWarmUpPairs + 1;
  EXPECT_THROW(runSpeedBenchmark(settings, test::silent()), std::invalid_argument) << "too few pairs";
}

TEST(SpeedBenchmark, TimesEachSizeWithEachNumberOfFeatures) {
  const test::TemporaryFolder cache;
  SpeedSettings settings;
  settings.sizes = {{340, 210}};
  settings.features = {100, 300};
  settings.threads = {1};
  settings.pairs = kWarmUpPairs + 2;
  settings.repeats = 2;
  settings.cache = cache.path();
  const std::vector<SpeedResult> results = runSpeedBenchmark(settings, test::silent());
  ASSERT_EQ(results.size(), 2u);
  for (const SpeedResult& result : results) {
    EXPECT_EQ(result.drive, "campus");
    EXPECT_EQ(result.size, settings.sizes[0]);
    EXPECT_EQ(result.pairs, 4u) << "without the warm-up pairs";
    EXPECT_GT(result.rectified.median, 0.0);
    EXPECT_GT(result.raw.median, result.rectified.median) << "the lens is rectified";
    EXPECT_GT(result.stage(vo::Stage::rectify), 0.0);
    EXPECT_GT(result.reference.klt, 0.0);
    EXPECT_GT(result.reference.remap, 0.0);
    EXPECT_GT(result.rectified_ratio, 0.0);
    EXPECT_GT(result.raw_ratio, 0.0);
    EXPECT_GT(result.used, 30.0) << "the odometry works";
  }
  EXPECT_GT(results[1].used, results[0].used);

  const std::string text = speedTables(results, ReportFormat::text);
  EXPECT_THAT(text, HasSubstr("340x210"));
  EXPECT_THAT(text, HasSubstr("over features"));
  const nlohmann::ordered_json json = speedJson(results);
  ASSERT_EQ(json["speeds"].size(), 2u);
  EXPECT_EQ(json["speeds"][1]["features"], 300);
  EXPECT_EQ(json["speeds"][0]["drive"], "campus");
  EXPECT_GT(json["speeds"][0]["rectified_ratio"], 0.0);
}

/// A data folder with one sequence of `count` images, in KITTI's layout.
std::filesystem::path linkedSequence(const test::TemporaryFolder& data, const std::filesystem::path& source,
                                     int count) {
  std::filesystem::path folder = data / "short";
  for (const char* camera : {"image_0", "image_1"}) {
    std::filesystem::create_directories(folder / camera);
    for (int i = 0; i < count; ++i) {
      const std::string name = "00000" + std::to_string(i) + ".png";
      std::filesystem::create_symlink(source / camera / name, folder / camera / name);
    }
  }
  std::filesystem::create_symlink(source / "calib.txt", folder / "calib.txt");
  std::ofstream times(folder / "times.txt"), poses(folder / "poses.txt");
  for (int i = 0; i < count; ++i) {
    times << 0.1 * i << "\n";
    poses << "1 0 0 0 0 1 0 0 0 0 1 " << i << "\n";
  }
  return folder;
}

SpeedSettings realOnly(const std::filesystem::path& data) {
  SpeedSettings settings;
  settings.data = data;
  settings.features = {300};
  settings.threads = {1};
  settings.pairs = kWarmUpPairs + 2;
  settings.repeats = 1;
  return settings;
}

TEST(SpeedBenchmark, TimesRectifiedSequencesAlsoWithLensDistortion) {
  CARTVO_NEEDS_DATA(kitti, "kitti_06");
  const test::TemporaryFolder data;
  linkedSequence(data, kitti, kWarmUpPairs + 3);
  const std::vector<SpeedResult> results = runSpeedBenchmark(realOnly(data.path()), test::silent());
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].drive, "short");
  EXPECT_EQ(results[1].drive, "short behind lenses");
  for (const SpeedResult& result : results) {
    EXPECT_EQ(result.size, cv::Size(1226, 370));
    EXPECT_EQ(result.pairs, 2u) << "settings.pairs without the warm-up pairs";
    EXPECT_GT(result.used, 100.0) << "the odometry works";
    EXPECT_GT(result.reference.klt, 0.0);
  }
  EXPECT_GT(results[1].raw.median, results[1].rectified.median) << "the lenses are rectified";
}

TEST(ThroughLenses, RectificationRestoresTheImages) {
  CARTVO_NEEDS_DATA(kitti, "kitti_06");
  const DriveInMemory drive = loadDrive("kitti_06", kitti, 1);
  ASSERT_TRUE(isRectified(drive));
  const DriveInMemory distorted = throughLenses(drive);
  EXPECT_FALSE(isRectified(distorted));
  const calib::Rectifier rectifier(distorted.rig, {}, calib::buildTables(distorted.rig, {}));
  const calib::Rectification& rectification = rectifier.rectification();
  // The map from pinhole pixels to rectified pixels: the same rays with another focal length.
  const calib::CameraModel& pinhole = drive.rig.left;
  const double scale = rectification.focal_length / pinhole.fx;
  const cv::Matx23d to_rectified(scale, 0, rectification.cx - scale * pinhole.cx, 0, scale,
                                 rectification.cy - scale * pinhole.cy);
  const auto expect_similar = [&](const cv::Mat& image, const cv::Mat& rectified) {
    cv::Mat expected;
    cv::warpAffine(image, expected, to_rectified, rectified.size(), cv::INTER_CUBIC);
    cv::Mat difference;
    cv::absdiff(expected, rectified, difference);
    const cv::Rect inner(20, 20, rectified.cols - 40, rectified.rows - 40);
    EXPECT_LT(cv::mean(difference(inner))[0], 3.0) << "grey values";
  };
  cv::Mat left, right;
  rectifier.rectifyLeft(distorted.pairs[0].left.image, left);
  rectifier.rectifyRight(distorted.pairs[0].right.image, right);
  expect_similar(drive.pairs[0].left.image, left);
  expect_similar(drive.pairs[0].right.image, right);
}

TEST(SpeedBenchmark, ErrorNamesTheSequenceThatIsTooShort) {
  CARTVO_NEEDS_DATA(kitti, "kitti_06");
  const test::TemporaryFolder data;
  const std::filesystem::path folder = linkedSequence(data, kitti, 5);
  EXPECT_THAT([&] { runSpeedBenchmark(realOnly(data.path()), test::silent()); },
              ::testing::ThrowsMessage<std::runtime_error>(
                  AllOf(HasSubstr(folder.string()), HasSubstr("too few pairs to time: 5"))));
}

}  // namespace
}  // namespace cartvo::benchmark
