// Replay: every pair is processed, in order, with the same result each time.

#include <cmath>
#include <cstring>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/pipeline.hpp"
#include "synthetic_cameras.hpp"

namespace cartvo {
namespace {

constexpr int kFrames = 40;

std::vector<Frame> frames(int disparity, std::int64_t offset_ns) {
  std::vector<Frame> list;
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
};

Replay replay(std::vector<Frame> left_frames, std::vector<Frame> right_frames, std::int64_t period_ns,
              double scale_deviation = 0.0) {
  Rig rig = test::smallRig();
  rig.scale_deviation = scale_deviation;
  PairProcessor processor = test::smallProcessor(rig);
  test::ListedCamera left(std::move(left_frames));
  test::ListedCamera right(std::move(right_frames));
  Pipeline pipeline(left, right, processor, settings(period_ns));
  Replay replay;
  pipeline.replay({[&](const PairResult& result) { replay.results.push_back(result); }, {}});
  replay.counts = pipeline.counts();
  return replay;
}

TEST(PipelineReplay, ProcessesEveryPairInOrderAndDropsNone) {
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
}

TEST(PipelineReplay, MeasuresTheMotionOfTheBody) {
  // The wall passes to the left: the cart, looking at it, goes to the right (-y) by 33.3 mm a frame of 20 ms.
  const Replay run = replay(frames(0, 0), frames(12, 0), test::kPeriod_ns);
  const PairResult& last = run.results.back();
  ASSERT_TRUE(last.estimate.valid) << "matched " << last.estimate.counts.matched << " of "
                                   << last.estimate.counts.detected << " inliers "
                                   << last.estimate.counts.inliers;
  EXPECT_NEAR(last.motion.velocity.y(), -2.0 * 4.0 / 240.0 / 0.02, 0.05);
  EXPECT_NEAR(last.motion.velocity.x(), 0.0, 0.1);
  EXPECT_GT(last.times.total, 0.0);
  EXPECT_GE(last.times.total, last.times.of(Stage::rectify));
}

TEST(PipelineReplay, OwnsUpToTheRigsScale) {
  constexpr double kScale = 0.05;
  const BodyMotion exact = replay(frames(0, 0), frames(12, 0), test::kPeriod_ns).results.back().motion;
  const BodyMotion vague =
      replay(frames(0, 0), frames(12, 0), test::kPeriod_ns, kScale).results.back().motion;
  EXPECT_EQ(vague.velocity, exact.velocity) << "it is no noise";
  const auto added = [&](double vague_variance, double exact_variance) {
    return std::sqrt(vague_variance - exact_variance);
  };
  EXPECT_NEAR(added(vague.twist_covariance(1, 1), exact.twist_covariance(1, 1)),
              kScale * std::abs(exact.velocity.y()), 0.05 * kScale * std::abs(exact.velocity.y()));
  const double way = std::abs(exact.T_world_body.translation().y());
  EXPECT_NEAR(added(vague.pose_covariance(1, 1), exact.pose_covariance(1, 1)), kScale * way,
              0.05 * kScale * way);
}

TEST(PipelineReplay, GivesTheSameBitsTwice) {
  const Replay first = replay(frames(0, 0), frames(12, 0), test::kPeriod_ns);
  const Replay second = replay(frames(0, 0), frames(12, 0), test::kPeriod_ns);
  ASSERT_EQ(first.results.size(), second.results.size());
  for (std::size_t i = 0; i < first.results.size(); ++i) {
    const Eigen::Matrix4d a = first.results[i].motion.T_world_body.matrix();
    const Eigen::Matrix4d b = second.results[i].motion.T_world_body.matrix();
    EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(double) * 16), 0) << "pair " << i;
  }
}

TEST(PipelineReplay, LeavesOutDamagedFramesAndThoseWithoutAPartner) {
  std::vector<Frame> left = frames(0, 0);
  std::vector<Frame> right = frames(12, 0);
  left[10].status = FrameStatus::damaged;
  right.erase(right.begin() + 20);
  const Replay run = replay(left, right, test::kPeriod_ns);
  EXPECT_EQ(run.results.size(), kFrames - 2);
  EXPECT_EQ(run.counts.dropped_damaged, 1u);
  EXPECT_EQ(run.counts.dropped_no_partner, 2u) << "left 20, and right 10 whose partner was damaged";
  for (const PairResult& result : run.results)
    EXPECT_EQ(result.left.sequence, result.right.sequence);
}

TEST(PipelineReplay, RefusesAnotherSizeThanTheRigs) {
  std::vector<Frame> left = frames(0, 0);
  left[5].image = cv::Mat::zeros(576, 704, CV_8UC1);
  try {
    replay(left, frames(12, 0), test::kPeriod_ns);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("left camera: the stream is 704x576, but the rig is for 320x240"));
  }
}

TEST(PipelineReplay, EndsWhenItIsStopped) {
  const Rig rig = test::smallRig();
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
}  // namespace cartvo
