// Tests of the whole odometry in a rendered corridor with known motion, and with faulty input.
#include "vo_core/stereo_odometry.hpp"

#include <Eigen/Eigenvalues>
#include <set>

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "support/vo_core/corridor_world.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{260.0, 208.0, 112.0, 0.2, 416, 224};
constexpr std::int64_t kPeriod = 50'000'000;  // ns

Eigen::Isometry3d drive(double frame) {
  Vector6d vector;
  vector << 0.01 * frame, 0.004 * frame, 0.15 * frame, 0.001 * frame, 0.006 * frame, -0.002 * frame;
  return motionFromVector(vector);
}

/// The drive's pairs, rendered once.
const std::vector<StereoImages>& drivePairs() {
  static const std::vector<StereoImages> pairs = [] {
    std::vector<StereoImages> rendered;
    const test::CorridorWorld world(1);
    for (int i = 0; i < 10; ++i)
      rendered.push_back(world.render(kCamera, drive(i), i * kPeriod));
    return rendered;
  }();
  return pairs;
}

std::vector<OdometryEstimate> run(const std::vector<StereoImages>& pairs, const OdometrySettings& settings) {
  StereoOdometry odometry(kCamera, settings);
  NullStageObserver observer;
  std::vector<OdometryEstimate> estimates;
  for (const StereoImages& pair : pairs)
    estimates.push_back(odometry.process(pair, observer));
  return estimates;
}

StereoImages uniformPair(int grey, std::int64_t time_ns) {
  const cv::Mat image(kCamera.height, kCamera.width, CV_8UC1, cv::Scalar(grey));
  return {image, image, time_ns, time_ns};
}

class EachEstimator : public testing::TestWithParam<Estimator> {
 protected:
  OdometrySettings smallSettings() const {
    OdometrySettings settings;
    settings.estimator = GetParam();
    settings.features = 400;
    return settings;
  }
};
INSTANTIATE_TEST_SUITE_P(Odometry, EachEstimator, testing::Values(Estimator::reprojection, Estimator::thesis),
                         [](const auto& tested) {
                           return tested.param == Estimator::thesis ? "Thesis" : "Reprojection";
                         });

TEST_P(EachEstimator, TracksAKnownMotion) {
  const auto estimates = run(drivePairs(), smallSettings());
  EXPECT_FALSE(estimates[0].valid);
  EXPECT_EQ(estimates[0].reasons, OdometryReason::first_pair);
  for (std::size_t i = 1; i < estimates.size(); ++i) {
    ASSERT_TRUE(estimates[i].valid) << i;
    EXPECT_EQ(estimates[i].reasons, OdometryReason::none);
    EXPECT_EQ(estimates[i].reset_counter, 0U);
    EXPECT_NEAR(estimates[i].time_step, 0.05, 1e-9);
    const auto frame = static_cast<double>(i);
    const Vector6d error = vectorFromMotion(estimates[i].T_world_camera.inverse() * drive(frame));
    EXPECT_LT(error.head<3>().norm(), 0.01 * 0.15 * frame + 0.004) << i;
    EXPECT_LT(error.tail<3>().norm(), 0.002) << i;
    EXPECT_GE(estimates[i].counts.detected, estimates[i].counts.tracked);
    EXPECT_GE(estimates[i].counts.tracked, estimates[i].counts.matched);
    EXPECT_GE(estimates[i].counts.matched, estimates[i].counts.inliers);
    EXPECT_GE(estimates[i].counts.detected, estimates[i].counts.stereo);
    EXPECT_GT(estimates[i].counts.stereo, estimates[i].counts.detected / 2);
    EXPECT_GT(
        Eigen::SelfAdjointEigenSolver<Matrix6d>(estimates[i].motion_covariance).eigenvalues().minCoeff(),
        0.0);
  }
  ASSERT_FALSE(estimates.empty());
  EXPECT_GT(estimates.back().pose_covariance.trace(), estimates[1].pose_covariance.trace());
}

TEST_P(EachEstimator, PoseIsTheReferenceTimesTheMotion) {
  const auto estimates = run(drivePairs(), smallSettings());
  // A pair also corrects the previous pose, which has been published.
  const double correction = GetParam() == Estimator::thesis ? 1e-9 : 4e-3;
  for (std::size_t i = 1; i < estimates.size(); ++i)
    EXPECT_LT((estimates[i].T_world_camera.matrix() -
               (estimates[i - 1].T_world_camera * estimates[i].T_previous_current).matrix())
                  .norm(),
              correction)
        << i;
}

TEST_P(EachEstimator, GivesTheSameEstimatesForAcquiredBuffers) {
  const auto copied = run(drivePairs(), smallSettings());
  StereoOdometry odometry(kCamera, smallSettings());
  NullStageObserver observer;
  for (std::size_t i = 0; i < copied.size(); ++i) {
    StereoImages placed = drivePairs()[i];
    placed.left = placed.right = cv::Mat();
    odometry.acquireBuffers(placed);
    drivePairs()[i].left.copyTo(placed.left);
    if (i % 3 == 0) placed.right = cv::Mat();  // as of an image that is not copied to the buffer
    drivePairs()[i].right.copyTo(placed.right);
    const OdometryEstimate estimate = odometry.process(placed, observer);
    EXPECT_EQ(estimate.T_world_camera.matrix(), copied[i].T_world_camera.matrix());
    EXPECT_EQ(estimate.pose_covariance, copied[i].pose_covariance);
  }
}

TEST_P(EachEstimator, GivesTheSameEstimatesForAnyNumberOfThreads) {
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = run(drivePairs(), smallSettings());
  cv::setNumThreads(2);
  const auto two = run(drivePairs(), smallSettings());
  cv::setNumThreads(threads);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].T_world_camera.matrix(), two[i].T_world_camera.matrix());
    EXPECT_EQ(one[i].pose_covariance, two[i].pose_covariance);
  }
}

TEST_P(EachEstimator, IdenticalImagesGiveZeroMotion) {
  StereoImages pair = drivePairs()[0];
  std::vector<StereoImages> pairs;
  for (int i = 0; i < 5; ++i) {
    pair.left_exposure_ns = pair.right_exposure_ns = i * kPeriod;
    pairs.push_back(pair);
  }
  const auto estimates = run(pairs, smallSettings());
  for (std::size_t i = 1; i < estimates.size(); ++i) {
    EXPECT_TRUE(estimates[i].valid);
    // Not exactly zero: an alignment starts at the prediction and ends when its steps are short; patches are
    // sampled at 255ths of a pixel.
    EXPECT_LT(vectorFromMotion(estimates[i].T_world_camera).norm(), 5e-5);
  }
}

TEST_P(EachEstimator, ImagesWithoutTextureHaveTooFewFeatures) {
  for (const int grey : {0, 128, 255}) {
    const auto estimates = run(
        {uniformPair(grey, 0), uniformPair(grey, kPeriod), uniformPair(grey, 2 * kPeriod)}, smallSettings());
    EXPECT_EQ(estimates[2].reasons, OdometryReason::too_few_features);
    EXPECT_FALSE(estimates[2].valid);
    EXPECT_EQ(estimates[2].T_previous_current.matrix(), Eigen::Matrix4d::Identity());
  }
}

TEST_P(EachEstimator, BridgesAShortGap) {
  std::vector<StereoImages> pairs(drivePairs().begin(), drivePairs().begin() + 7);
  pairs[3] = uniformPair(0, 3 * kPeriod);
  pairs[4] = uniformPair(0, 4 * kPeriod);
  const auto estimates = run(pairs, smallSettings());
  EXPECT_FALSE(estimates[3].valid);
  EXPECT_FALSE(estimates[4].valid);
  EXPECT_EQ(estimates[4].T_world_camera.matrix(), estimates[2].T_world_camera.matrix());
  ASSERT_TRUE(estimates[5].valid);
  EXPECT_EQ(estimates[5].reset_counter, 0U);
  EXPECT_NEAR(estimates[5].time_step, 0.15, 1e-9);
  EXPECT_LT((estimates[5].T_world_camera.translation() - drive(5).translation()).norm(), 0.03);
}

TEST_P(EachEstimator, StartsANewEpochAfterALoss) {
  const test::CorridorWorld elsewhere(99);
  std::vector<StereoImages> pairs(drivePairs().begin(), drivePairs().begin() + 4);
  for (int i = 4; i < 7; ++i)
    pairs.push_back(elsewhere.render(kCamera, drive(i), i * kPeriod));
  const auto estimates = run(pairs, smallSettings());
  EXPECT_TRUE(estimates[3].valid);
  EXPECT_FALSE(estimates[4].valid);  // the world changes
  EXPECT_EQ(estimates[4].reset_counter, 0U);
  ASSERT_TRUE(estimates[5].valid);
  EXPECT_EQ(estimates[5].reset_counter, 1U);
  EXPECT_EQ(estimates[6].reset_counter, 1U);
  const Eigen::Isometry3d expected = drive(4).inverse() * drive(5);  // the world is the camera of pair 4
  EXPECT_LT((estimates[5].T_world_camera.translation() - expected.translation()).norm(), 0.01);
}

TEST(StereoOdometry, EndsNoEpochThatHasNoMotion) {
  std::vector<StereoImages> pairs;
  constexpr int kGrey = 20;
  for (int i = 0; i < kGrey; ++i)
    pairs.push_back(uniformPair(128, i * kPeriod));
  for (int i = 0; i < 3; ++i) {
    pairs.push_back(drivePairs()[i]);
    pairs.back().left_exposure_ns = pairs.back().right_exposure_ns = (kGrey + i) * kPeriod;
  }
  OdometrySettings settings;
  settings.features = 400;
  const auto estimates = run(pairs, settings);
  ASSERT_TRUE(estimates.back().valid);
  EXPECT_EQ(estimates.back().reset_counter, 0U);
}

TEST_P(EachEstimator, StartsANewEpochAtATimeStepOutOfRange) {
  for (const std::int64_t step : {std::int64_t{0}, -kPeriod, 10'000'000'000}) {
    std::vector<StereoImages> pairs(drivePairs().begin(), drivePairs().begin() + 4);
    const std::int64_t before = pairs[1].left_exposure_ns;
    pairs[2].left_exposure_ns = before + step;
    pairs[3].left_exposure_ns = before + step + kPeriod;
    for (const int i : {2, 3})
      pairs[i].right_exposure_ns = pairs[i].left_exposure_ns;
    const auto estimates = run(pairs, smallSettings());
    EXPECT_EQ(estimates[2].reasons, OdometryReason::time_step);
    EXPECT_EQ(estimates[2].reset_counter, 1U);
    EXPECT_EQ(estimates[2].T_world_camera.matrix(), Eigen::Matrix4d::Identity());
    EXPECT_TRUE(estimates[3].valid);
    EXPECT_EQ(estimates[3].reset_counter, 1U);
  }
}

TEST_P(EachEstimator, RejectsExposuresTooFarApart) {
  if (GetParam() == Estimator::thesis) GTEST_SKIP() << "treats both exposures as simultaneous";
  std::vector<StereoImages> pairs(drivePairs().begin(), drivePairs().begin() + 3);
  pairs[2].right_exposure_ns += 200'000'000;
  const auto estimates = run(pairs, smallSettings());
  EXPECT_FALSE(estimates[2].valid);
  EXPECT_EQ(estimates[2].reasons, OdometryReason::offset_too_large);
  EXPECT_EQ(estimates[2].reset_counter, 0U);
}

TEST_P(EachEstimator, SwappedImagesGiveNoMotion) {
  std::vector<StereoImages> pairs(drivePairs().begin(), drivePairs().begin() + 6);
  for (StereoImages& pair : pairs)
    std::swap(pair.left, pair.right);
  for (const OdometryEstimate& estimate : run(pairs, smallSettings()))
    EXPECT_FALSE(estimate.valid);
}

TEST_P(EachEstimator, NoiseGivesNoMotion) {
  cv::RNG random(5);
  std::vector<StereoImages> pairs;
  for (int i = 0; i < 5; ++i) {
    StereoImages pair = uniformPair(0, i * kPeriod);
    pair.left = pair.left.clone();
    pair.right = pair.right.clone();
    random.fill(pair.left, cv::RNG::UNIFORM, 0, 255);
    random.fill(pair.right, cv::RNG::UNIFORM, 0, 255);
    pairs.push_back(pair);
  }
  for (const OdometryEstimate& estimate : run(pairs, smallSettings()))
    EXPECT_FALSE(estimate.valid);
}

TEST_P(EachEstimator, ReportsEachStageOncePerPair) {
  struct Recorder final : StageObserver {
    std::vector<Stage> begun;
    std::vector<Stage> ended;
    void begin(Stage stage) override { begun.push_back(stage); }
    void end(Stage stage) override { ended.push_back(stage); }
  } recorder;
  StereoOdometry odometry(kCamera, smallSettings());
  NullStageObserver null_observer;
  odometry.process(drivePairs()[0], null_observer);
  odometry.process(drivePairs()[1], recorder);
  EXPECT_EQ(recorder.begun, recorder.ended);
  EXPECT_GE(recorder.begun.size(), 6U);
  EXPECT_EQ(std::set<Stage>(recorder.begun.begin(), recorder.begun.end()).size(), recorder.begun.size());
}

TEST_P(EachEstimator, ContinuesWhenTheTargetFeatureCountChanges) {
  StereoOdometry odometry(kCamera, smallSettings());
  NullStageObserver observer;
  const std::vector<StereoImages>& pairs = drivePairs();
  ASSERT_GE(pairs.size(), 7U);
  const int all = odometry.process(pairs[0], observer).counts.detected;
  odometry.setTargetFeatureCount(60);
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_TRUE(odometry.process(pairs[i], observer).valid);
  const int few = odometry.process(pairs[4], observer).counts.detected;
  EXPECT_LT(few, all);
  if (GetParam() == Estimator::reprojection) {
    EXPECT_LE(few, 60) << "the thesis estimator keeps features until they are lost";
  }
  odometry.setTargetFeatureCount(smallSettings().features);
  EXPECT_GT(odometry.process(pairs[5], observer).counts.detected, few);
  EXPECT_TRUE(odometry.process(pairs[6], observer).valid);
  EXPECT_THROW(odometry.setTargetFeatureCount(0), std::invalid_argument);
}

TEST_P(EachEstimator, RejectsImagesOfAnotherSize) {
  StereoOdometry odometry(kCamera, smallSettings());
  NullStageObserver observer;
  StereoImages pair = drivePairs()[0];
  pair.right = cv::Mat(10, 10, CV_8UC1);
  EXPECT_THROW(odometry.process(pair, observer), std::invalid_argument);
}

// Key frames show the world ahead of their pose, which residuals do not show.
TEST(CodecErrors, ShiftOfKeyFramesIsInTheCovariances) {
  constexpr int kPairs = 18, kInterval = 8;
  constexpr double kAhead = 0.0012;  // m
  const test::CorridorWorld world(1);
  std::vector<StereoImages> pairs;
  for (int i = 0; i < kPairs; ++i) {
    const bool is_key = i > 0 && i % kInterval == 0;
    const Eigen::Isometry3d shown = drive(i) * Eigen::Translation3d(0.0, 0.0, is_key ? kAhead : 0.0);
    pairs.push_back(world.render(kCamera, shown, i * kPeriod));
    pairs.back().key_frames = {is_key, is_key};
  }
  const std::vector<OdometryEstimate> with_key_frames = run(pairs, {});
  for (StereoImages& pair : pairs)
    pair.key_frames = {};
  const std::vector<OdometryEstimate> without_key_frames = run(pairs, {});
  const auto error_in_stddevs = [](const OdometryEstimate& estimate, int pair) {
    const double truth = (drive(pair - 1).inverse() * drive(pair)).translation().z();
    return std::abs(estimate.T_previous_current.translation().z() - truth) /
           std::sqrt(estimate.motion_covariance(2, 2));
  };
  for (int i = 1; i < kPairs; ++i) {
    ASSERT_TRUE(with_key_frames[i].valid) << i;
    EXPECT_LT(error_in_stddevs(with_key_frames[i], i), 3.0) << i;
    if (i > kInterval && i % kInterval == 1) {
      EXPECT_GT(error_in_stddevs(without_key_frames[i], i), 3.0) << i;
    }
  }
}

/// Pairs whose poses are alternately a few millimetres ahead and behind; `first`: key frames of the first
/// one.
std::vector<StereoImages> roughPairs(int count, KeyFrames first) {
  constexpr double kOff = 0.004;  // m
  const test::CorridorWorld world(1);
  std::vector<StereoImages> pairs;
  for (int i = 0; i < count; ++i) {
    const Eigen::Isometry3d shown = drive(i) * Eigen::Translation3d(0.0, 0.0, i % 2 == 0 ? kOff : -kOff);
    pairs.push_back(world.render(kCamera, shown, i * kPeriod));
  }
  if (!pairs.empty()) pairs.front().key_frames = first;
  return pairs;
}

TEST(CodecErrors, InflateTheCovariances) {
  constexpr int kPairs = 18;
  const std::vector<OdometryEstimate> video = run(roughPairs(kPairs, {true, true}), {});
  const std::vector<OdometryEstimate> images = run(roughPairs(kPairs, {}), {});
  ASSERT_TRUE(video.back().valid && images.back().valid);
  EXPECT_GT(video.back().motion_covariance(2, 2), 4.0 * images.back().motion_covariance(2, 2));
  EXPECT_GT(video.back().pose_covariance(2, 2), 1.5 * images.back().pose_covariance(2, 2));
  EXPECT_LT((video.back().T_world_camera.inverse() * images.back().T_world_camera).translation().norm(),
            0.01);
}

TEST(CodecErrors, AreNotEstimatedFromFirstMotions) {
  constexpr int kFirst = 7;  // pairs whose noise is not calibrated
  const std::vector<OdometryEstimate> video = run(roughPairs(kFirst, {true, true}), {});
  std::vector<StereoImages> calm;
  const test::CorridorWorld world(1);
  for (int i = 0; i < kFirst; ++i)
    calm.push_back(world.render(kCamera, drive(i), i * kPeriod));
  calm.front().key_frames = {true, true};
  const std::vector<OdometryEstimate> quiet = run(calm, {});
  EXPECT_LT(video.back().motion_covariance(2, 2), 2.0 * quiet.back().motion_covariance(2, 2));
}

}  // namespace
}  // namespace cartvo::vo
