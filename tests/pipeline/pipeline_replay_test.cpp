// Pipeline in replay: processes every pair in order and is reproducible.

#include <chrono>
#include <cmath>
#include <cstring>
#include <deque>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/diagnostics/health_monitor.hpp"
#include "pipeline/pipeline.hpp"
#include "support/capture/synthetic_cameras.hpp"

namespace cartvo::pipeline {
namespace {

constexpr int kFrames = 24;

std::vector<capture::Frame> frames(int disparity, std::int64_t offset_ns) {
  std::vector<capture::Frame> list;
  for (int i = 0; i < kFrames; ++i)
    list.push_back(test::wallFrame(i, disparity, i * test::kPeriod_ns + offset_ns));
  return list;
}

PipelineSettings settings(std::int64_t period_ns) {
  return {{320, 240}, period_ns};
}

struct Replay {
  std::vector<PairResult> results;
  PipelineCounts counts;
  std::vector<std::size_t> offset_updates;  ///< results at each update of the clock model's visual offset
};

Replay replay(std::vector<capture::Frame> left_frames, std::vector<capture::Frame> right_frames,
              std::int64_t period_ns, double scale_stddev = 0.0,
              const AlertLimits& alert_limits = test::kNoAlertLimits) {
  calib::Rig rig = test::smallRig();
  rig.scale_stddev = scale_stddev;
  PairProcessor processor = test::smallProcessor(rig, alert_limits);
  test::ListedCamera left(std::move(left_frames));
  test::ListedCamera right(std::move(right_frames));
  Replay replay;
  PipelineSettings with_updates = settings(period_ns);
  with_updates.set_visual_offset = [&](const std::optional<capture::OffsetEstimate>&) {
    replay.offset_updates.push_back(replay.results.size());
  };
  Pipeline pipeline(left, right, processor, with_updates);
  pipeline.replay({[&](const PairResult& result) { replay.results.push_back(result); }, {}});
  replay.counts = pipeline.counts();
  return replay;
}

/// Of cameras without a time offset, for tests that compare another replay with it.
const Replay& plainReplay() {
  static const Replay kReplay = replay(frames(0, 0), frames(12, 0), test::kPeriod_ns);
  return kReplay;
}

TEST(PipelineReplay, ProcessesEveryPairInOrder) {
  const Replay run = replay(frames(0, 0), frames(12, 3'000'000), test::kPeriod_ns);
  ASSERT_EQ(run.results.size(), kFrames);
  EXPECT_EQ(run.counts.processed, kFrames);
  EXPECT_EQ(run.counts.skipped, 0u);
  EXPECT_EQ(run.counts.dropped_no_partner, 0u);
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_EQ(run.results[i].sequence, i);
    EXPECT_EQ(run.results[i].left.exposure_ns, i * test::kPeriod_ns);
    EXPECT_EQ(run.results[i].offset_ns(), 3'000'000);
  }
  ASSERT_EQ(run.offset_updates.size(), run.results.size());
  for (std::size_t i = 0; i < run.results.size(); ++i)
    EXPECT_EQ(run.offset_updates[i], i) << "the visual offset is updated before each result";
}

/// Wants every other pair.
class EveryOtherPair : public PairViewer {
 public:
  PairView* nextView() override { return ++pairs_ % 2 == 0 ? &views_.emplace_back() : nullptr; }
  const std::deque<PairView>& views() const { return views_; }

 private:
  int pairs_ = 0;
  std::deque<PairView> views_;
};

TEST(PipelineReplay, IsBitwiseReproducibleAlsoWhileItCopiesPairsForADisplay) {
  const Replay& plain = plainReplay();
  PairProcessor processor = test::smallProcessor(test::smallRig());
  EveryOtherPair viewer;
  processor.setViewer(viewer);
  test::ListedCamera left(frames(0, 0)), right(frames(12, 0));
  Pipeline pipeline(left, right, processor, settings(test::kPeriod_ns));
  std::vector<PairResult> results;
  pipeline.replay({[&](const PairResult& result) { results.push_back(result); }, {}});
  ASSERT_EQ(results.size(), plain.results.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Eigen::Matrix4d a = results[i].motion.T_world_body.matrix();
    const Eigen::Matrix4d b = plain.results[i].motion.T_world_body.matrix();
    EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(double) * 16), 0) << "pair " << i;
  }
  ASSERT_EQ(viewer.views().size(), kFrames / 2);
  for (const PairView& view : viewer.views()) {
    EXPECT_EQ(view.left.size(), view.right.size());
    EXPECT_GT(cv::countNonZero(view.left), 0);
    for (const vo::LandmarkView& landmark : view.landmarks) {
      EXPECT_TRUE(landmark.left_x >= 0.0F && landmark.left_x < static_cast<float>(view.left.cols));
      EXPECT_TRUE(landmark.weight >= 0.0F && landmark.weight <= 1.0F);
      EXPECT_GE(landmark.age, 1);
    }
  }
  EXPECT_GT(viewer.views().back().landmarks.size(), 10U);
}

TEST(PipelineReplay, ComputesBodyMotion) {
  // The wall moves to the left in the images: the cart moves to the right (-y) by 33.3 mm per frame of 20 ms.
  const Replay& run = plainReplay();
  ASSERT_FALSE(run.results.empty());
  const PairResult& last = run.results.back();
  ASSERT_TRUE(last.estimate.valid) << "matched " << last.estimate.counts.matched << " of "
                                   << last.estimate.counts.detected << " inliers "
                                   << last.estimate.counts.inliers;
  EXPECT_NEAR(last.motion.velocity.y(), -2.0 * 4.0 / 240.0 / 0.02, 0.05);
  EXPECT_NEAR(last.motion.velocity.x(), 0.0, 0.1);
  EXPECT_GT(last.times.total, 0.0);
  EXPECT_GE(last.times.total, last.times.stage(vo::Stage::rectify));
}

TEST(PipelineReplay, TakesTimeStepsFromTheCamerasOwnClock) {
  // The exposures are being corrected by a quarter of the time that passes.
  const auto slewed = [](int disparity) {
    std::vector<capture::Frame> list = frames(disparity, 0);
    for (int i = 0; i < kFrames; ++i)
      list[i].exposure_ns += list[i].slew_ns = i * test::kPeriod_ns / 4;
    return list;
  };
  const Replay& exact = plainReplay();
  const Replay run = replay(slewed(0), slewed(12), test::kPeriod_ns);
  ASSERT_EQ(run.results.size(), exact.results.size());
  EXPECT_EQ(run.results.back().motion.velocity, exact.results.back().motion.velocity);
  EXPECT_EQ(run.results.back().left.exposure_ns, (kFrames - 1) * test::kPeriod_ns * 5 / 4);
}

TEST(PipelineReplay, CovarianceIncludesRigScaleUncertainty) {
  constexpr double kScaleStddev = 0.05;
  const Replay& exact_run = plainReplay();
  const Replay uncertain_run = replay(frames(0, 0), frames(12, 0), test::kPeriod_ns, kScaleStddev);
  ASSERT_FALSE(exact_run.results.empty());
  ASSERT_FALSE(uncertain_run.results.empty());
  const BodyMotion& exact = exact_run.results.back().motion;
  const BodyMotion& uncertain = uncertain_run.results.back().motion;
  EXPECT_EQ(uncertain.velocity, exact.velocity) << "only the covariance changes";
  const auto added_stddev = [&](double uncertain_variance, double exact_variance) {
    return std::sqrt(uncertain_variance - exact_variance);
  };
  EXPECT_NEAR(added_stddev(uncertain.twist_covariance(1, 1), exact.twist_covariance(1, 1)),
              kScaleStddev * std::abs(exact.velocity.y()),
              0.05 * kScaleStddev * std::abs(exact.velocity.y()));
  const double distance = std::abs(exact.T_world_body.translation().y());
  EXPECT_NEAR(added_stddev(uncertain.pose_covariance(1, 1), exact.pose_covariance(1, 1)),
              kScaleStddev * distance, 0.05 * kScaleStddev * distance);
}

TEST(PipelineReplay, IsValidWhileEachBoundIsBelowItsAlertLimit) {
  const Replay& wide = plainReplay();
  ASSERT_TRUE(wide.results.back().isValid());
  const ProtectionLevel& level = wide.results.back().level;
  EXPECT_GT(level.velocity.minCoeff(), 0.0);
  EXPECT_GT(level.motion.minCoeff(), 0.0);

  AlertLimits limits = test::kNoAlertLimits;
  limits.velocity = 0.99 * level.velocity.maxCoeff();
  const Replay narrow = replay(frames(0, 0), frames(12, 0), test::kPeriod_ns, 0.0, limits);
  const PairResult& last = narrow.results.back();
  EXPECT_FALSE(last.isValid());
  EXPECT_TRUE(last.exceedsAlertLimit());
  EXPECT_TRUE(last.worst->quantity == BoundedQuantity::velocity);
  EXPECT_EQ(last.level.velocity, level.velocity) << "the bounds stay, so that one sees which is too large";
  EXPECT_TRUE(last.motion.velocity.array().isNaN().all());
  EXPECT_TRUE(last.motion.twist_covariance.array().isNaN().all());
  EXPECT_TRUE(last.estimate.valid) << "the estimator goes on";
  EXPECT_EQ(last.estimate.reset_counter, wide.results.back().estimate.reset_counter);
  EXPECT_EQ(last.motion.T_world_body.matrix(), wide.results.back().motion.T_world_body.matrix());
}

TEST(PipelineReplay, DropsDamagedFramesAndFramesWithoutPartner) {
  std::vector<capture::Frame> left = frames(0, 0);
  std::vector<capture::Frame> right = frames(12, 0);
  left[8].status = capture::FrameStatus::damaged;
  right.erase(right.begin() + 16);
  const Replay run = replay(left, right, test::kPeriod_ns);
  EXPECT_EQ(run.results.size(), kFrames - 2);
  EXPECT_EQ(run.counts.dropped_damaged, 1u);
  EXPECT_EQ(run.counts.dropped_no_partner, 2u) << "left 16, and right 8 whose partner was damaged";
  for (const PairResult& result : run.results)
    EXPECT_EQ(result.left.sequence, result.right.sequence);
}

TEST(PipelineReplay, RejectsFrameOfWrongSize) {
  std::vector<capture::Frame> left = frames(0, 0);
  left[5].image = cv::Mat::zeros(576, 704, CV_8UC1);
  try {
    replay(left, frames(12, 0), test::kPeriod_ns);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("left camera: the stream is 704x576, but the rig is for 320x240"));
  }
}

/// Expects that no pair is valid and that health names the fault in these words.
void expectFault(const Replay& run, const std::string& words) {
  daemon::HealthMonitor monitor{{}};
  for (const PairResult& result : run.results) {
    EXPECT_FALSE(result.estimate.valid) << result.sequence;
    odometry_t message{};
    message.status = odometry_t::INVALID;
    monitor.addPair(result, message);
  }
  const health_t health =
      monitor.summarise(daemon::HealthMonitor::Clock::time_point(std::chrono::seconds(1)), {});
  EXPECT_THAT(health.problem, testing::HasSubstr(words));
  EXPECT_THAT(health.self_check, testing::HasSubstr(words));
}

TEST(PipelineReplay, NamesExchangedCameras) {
  expectFault(replay(frames(12, 0), frames(0, 0), test::kPeriod_ns), "are exchanged");
}

TEST(PipelineReplay, NamesTheSameStreamTwice) {
  expectFault(replay(frames(0, 0), frames(0, 0), test::kPeriod_ns), "both cameras give the same picture");
}

TEST(PipelineReplay, EndsOnStop) {
  const calib::Rig rig = test::smallRig();
  PairProcessor processor = test::smallProcessor(rig);
  test::ListedCamera left(frames(0, 0));
  test::ListedCamera right(frames(12, 0));
  Pipeline pipeline(left, right, processor, settings(test::kPeriod_ns));
  int pairs = 0;
  pipeline.replay({[&](const PairResult&) {
                     if (++pairs == 5) pipeline.stop();
                   },
                   {}});
  EXPECT_EQ(pairs, 5);
}

}  // namespace
}  // namespace cartvo::pipeline
