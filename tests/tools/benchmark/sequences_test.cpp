// Tests of real sequences, rendered worlds and encoded streams, and small benchmark runs on them.
#include <cmath>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "support/pipeline/alert_limits.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/silent.hpp"
#include "support/tools/tiny_world.hpp"
#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "tools/benchmark/encoded_source.hpp"
#include "tools/benchmark/sequence.hpp"
#include "tools/benchmark/thesis/depth_regression.hpp"
#include "tools/benchmark/thesis/feature_counts.hpp"
#include "tools/benchmark/thesis/stage_times.hpp"
#include "tools/simulate/sequence_content.hpp"

namespace cartvo::benchmark {
namespace {

using test::silent;
using test::tinyWorld;

TEST(RealSequences, AreTheImageFoldersWithGroundTruth) {
  CARTVO_NEEDS_DATA(kitti, "kitti_06");
  CARTVO_NEEDS_DATA(still, "euroc_still");
  const std::vector<Sequence> sequences = realSequences(test::dataFolder());
  const auto named = [&](const std::string& name) {
    return std::find_if(sequences.begin(), sequences.end(),
                        [&](const Sequence& sequence) { return sequence.name == name; });
  };
  ASSERT_NE(named("kitti_06"), sequences.end());
  const Trajectory& moving = named("kitti_06")->truth.left_camera;
  ASSERT_EQ(moving.size(), 51u);
  EXPECT_TRUE(moving.front().pose.isApprox(Eigen::Isometry3d::Identity(), 1e-12));
  EXPECT_NEAR(moving.back().pose.translation().z(), 59.9, 0.5);
  EXPECT_GT(moving[1].time_ns, moving[0].time_ns);
  ASSERT_NE(named("euroc_still"), sequences.end());
  const Trajectory& standing = named("euroc_still")->truth.left_camera;
  ASSERT_EQ(standing.size(), 40u);
  EXPECT_TRUE(standing.back().pose.isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_EQ(named("board_opencv"), sequences.end());
}

TEST(RealSequences, WithWrongNumberOfPosesAreRejected) {
  const test::TemporaryFolder data;
  const std::filesystem::path folder = data / "drive";
  for (const char* camera : {"image_0", "image_1"}) {
    std::filesystem::create_directories(folder / camera);
    for (const char* name : {"000000.png", "000001.png"})
      cv::imwrite((folder / camera / name).string(), cv::Mat::zeros(32, 32, CV_8UC1));
  }
  std::ofstream(folder / "times.txt") << "0\n0.1\n";
  std::ofstream(folder / "poses.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  EXPECT_THAT([&] { realSequences(data.path()); },
              ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("1 poses for 2 images")));
}

TEST(WorldName, ContainsScenarioSeedAndOffset) {
  world::WorldSettings settings;
  settings.scenario = world::Scenario::stop_and_go;
  settings.seed = 3;
  EXPECT_EQ(worldName(settings), "stop_and_go 3");
  settings.offset_s = -0.0125;
  EXPECT_EQ(worldName(settings), "stop_and_go 3 -12.5 ms");
  settings.offset_drift_ppm = 50.0;
  EXPECT_EQ(worldName(settings), "stop_and_go 3 -12.5 ms +50 ppm");
}

class TinyWorldBenchmark : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { cache_ = std::make_unique<test::TemporaryFolder>(); }
  static void TearDownTestSuite() { cache_.reset(); }

  static inline std::unique_ptr<test::TemporaryFolder> cache_;
};

TEST_F(TinyWorldBenchmark, RendersOnceWithTruthAtEachInstant) {
  const WorldCache worlds(cache_->path() / "worlds");
  const Sequence sequence = renderedSequence(tinyWorld(), worlds, {});
  EXPECT_EQ(sequence.kind, SequenceKind::rendered);
  const world::RenderedWorld world(tinyWorld());
  ASSERT_EQ(static_cast<int>(sequence.truth.left_camera.size()), world.pairCount());
  ASSERT_EQ(sequence.truth.body_twist.size(), sequence.truth.left_camera.size());
  // The mean twist over a step equals the exact motion, except for the change of the twist within the step.
  const calib::Rig rig = world.rig();
  for (std::size_t i = 1; i < sequence.truth.left_camera.size(); ++i) {
    const double step = 1.0 / 9.0;
    const vo::Vector6d mean = 0.5 * step * (sequence.truth.body_twist[i - 1] + sequence.truth.body_twist[i]);
    const Eigen::Isometry3d body = rig.T_body_camera * sequence.truth.left_camera[i - 1].pose.inverse() *
                                   sequence.truth.left_camera[i].pose * rig.T_body_camera.inverse();
    EXPECT_LT((vo::vectorFromMotion(body) - mean).norm(), 0.01) << i;
  }
  const auto rendered_at = std::filesystem::last_write_time(sequence.folder / "poses.txt");
  EXPECT_EQ(renderedSequence(tinyWorld(), worlds, {}).folder, sequence.folder);
  EXPECT_EQ(std::filesystem::last_write_time(sequence.folder / "poses.txt"), rendered_at);
}

TEST_F(TinyWorldBenchmark, RendersOnlyRightImagesForAnotherTimeOffset) {
  const WorldCache worlds(cache_->path() / "worlds");
  const std::filesystem::path synchronised = renderedSequence(tinyWorld(), worlds, {}).folder;
  // A uniform image, which the renderer never produces, shows that the left image was copied.
  const std::filesystem::path first = "image_0/000000.png";
  const cv::Mat seen = cv::imread((synchronised / first).string(), cv::IMREAD_GRAYSCALE);
  const cv::Mat marked(seen.size(), CV_8UC1, cv::Scalar(77));
  cv::imwrite((synchronised / first).string(), marked);
  world::WorldSettings settings = tinyWorld();
  settings.offset_s = 0.02;
  const Sequence later = renderedSequence(settings, worlds, {});
  EXPECT_EQ(cv::norm(cv::imread((later.folder / first).string(), cv::IMREAD_GRAYSCALE), marked), 0.0);
  cv::imwrite((synchronised / first).string(), seen);
  const world::RenderedWorld world(settings);
  EXPECT_EQ(cv::norm(cv::imread((later.folder / "image_1/000003.png").string(), cv::IMREAD_GRAYSCALE),
                     world.image(3, capture::CameraSide::right)),
            0.0);
  std::filesystem::remove_all(later.folder);
}

TEST_F(TinyWorldBenchmark, MeasuresEachVariantLosslessAndEncoded) {
  AccuracySettings settings;
  settings.worlds = {tinyWorld()};
  vo::OdometrySettings odometry;
  odometry.estimator = vo::Estimator::thesis;
  odometry.features = 400;
  settings.variants = {{"thesis", odometry}};
  settings.bitrates_mbps = {8.0};
  settings.cache = cache_->path();
  settings.limits = test::kNoAlertLimits;
  const std::vector<SequenceAccuracy> accuracies = runAccuracyBenchmark(settings, silent());
  ASSERT_EQ(accuracies.size(), 2u);
  for (const SequenceAccuracy& accuracy : accuracies) {
    EXPECT_EQ(accuracy.sequence, "campus 1");
    EXPECT_EQ(accuracy.estimator, "thesis");
    EXPECT_EQ(accuracy.pairs, 6u);
    EXPECT_EQ(accuracy.invalid, 0u);
    EXPECT_EQ(accuracy.lost, 0u);
    EXPECT_EQ(accuracy.consistency.motion.groups(), 5u);
    EXPECT_EQ(accuracy.consistency.velocity.groups(), 5u);
    EXPECT_LT(accuracy.evaluation.relative_translation, 0.02);
  }
  EXPECT_DOUBLE_EQ(accuracies[0].bitrate_mbps, 0.0);
  EXPECT_DOUBLE_EQ(accuracies[1].bitrate_mbps, 8.0);
  EXPECT_NE(accuracies[0].evaluation.final_drift, accuracies[1].evaluation.final_drift)
      << "encoding must change the result";
}

TEST_F(TinyWorldBenchmark, DecodesEachPictureWithItsInstant) {
  const WorldCache worlds(cache_->path() / "worlds");
  const Sequence sequence = renderedSequence(tinyWorld(), worlds, {});
  const simulate::SequenceContent content(sequence.folder, {});
  const auto streams = std::make_shared<const simulate::EncodedPair>(
      simulate::encodeContent(content, {.bitrate_kbps = 20'000}, {}));
  const capture::StereoSource source = openEncoded(streams);
  EXPECT_EQ(source.pairs, 6u);
  cv::Mat left, right;
  capture::Frame frame;
  for (int index = 0; index < content.pairCount(); ++index) {
    ASSERT_EQ(source.right->read(frame, std::chrono::milliseconds(0)), capture::ReadOutcome::frame);
    content.images(index, left, right);
    EXPECT_EQ(frame.exposure_ns, content.rightInstant(index));
    EXPECT_EQ(frame.status, capture::FrameStatus::good);
    EXPECT_LT(cv::norm(frame.image, right, cv::NORM_L1) / static_cast<double>(right.total()), 3.0) << index;
  }
  EXPECT_EQ(source.right->read(frame, std::chrono::milliseconds(0)), capture::ReadOutcome::ended);
}

TEST(DepthRegression, IsExactForALineAndLowerWithScatter) {
  const DepthRegression line = regressDepth({{2.2, 2.0}, {4.2, 4.0}, {8.2, 8.0}});
  EXPECT_NEAR(line.r_squared, 1.0, 1e-12);
  EXPECT_NEAR(line.slope, 1.0, 1e-12);
  // By hand: x = 1, 2, 3 and y = 1, 3, 2 have xx = 2, xy = 1, yy = 2.
  const DepthRegression scattered = regressDepth({{1.0, 1.0}, {3.0, 2.0}, {2.0, 3.0}});
  EXPECT_NEAR(scattered.r_squared, 0.25, 1e-12);
  EXPECT_NEAR(scattered.slope, 0.5, 1e-12);
  EXPECT_EQ(closeDepths({{1.05, 1.0}, {1.2, 1.0}, {18.5, 20.0}}), 2u);
}

TEST(DepthRegression, IsBetterWithSubPixelDisparities) {
  world::WorldSettings world = tinyWorld();
  world.baseline = 0.5;  // for disparities far above one pixel
  const DepthSamples samples = measureDepths(world, 2, 400, [](int, int) {});
  ASSERT_GT(samples.sub_pixel.size(), 50u);
  EXPECT_GE(samples.sub_pixel.size(), samples.whole_pixel.size());
  EXPECT_LT(10 * samples.wrong, samples.sub_pixel.size());
  const DepthRegression sub_pixel = regressDepth(samples.sub_pixel);
  EXPECT_GT(sub_pixel.r_squared, 0.9);
  EXPECT_GT(sub_pixel.r_squared, regressDepth(samples.whole_pixel).r_squared);
  EXPECT_GE(closeDepths(samples.sub_pixel), closeDepths(samples.whole_pixel));
}

TEST(FeatureCounts, VaryLessWithAdaptiveThresholds) {
  CARTVO_NEEDS_DATA(sequence, "kitti_00");
  const vo::DetectionSettings adaptive;
  const FeatureCountSeries with = countFeatures(sequence, adaptive, 1000);
  const FeatureCountSeries without = countFeatures(sequence, withFixedThreshold(adaptive), 1000);
  ASSERT_EQ(with.corners.size(), 21u);
  EXPECT_LT(with.window_stddev / with.window_mean, without.window_stddev / without.window_mean);
  EXPECT_LT(with.starved, without.starved);
  EXPECT_GT(with.features_mean, 900.0);
}

TEST(StageTimes, AreMediansExceptTheFirstPair) {
  Replay replay;
  for (const double seconds : {9.0, 0.001, 0.003, 0.002}) {
    ReplayedPair pair;
    pair.times.stages[static_cast<std::size_t>(vo::Stage::detect)] = seconds;
    pair.times.total = 2.0 * seconds;
    replay.pairs.push_back(pair);
  }
  const StageMedians medians = stageMedians(replay);
  EXPECT_DOUBLE_EQ(medians.stage(vo::Stage::detect), 2.0);
  EXPECT_DOUBLE_EQ(medians.total, 4.0);
  EXPECT_GT(rectificationMs({320, 200}), 0.0);
}

}  // namespace
}  // namespace cartvo::benchmark
