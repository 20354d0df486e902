// Live pipeline: processes only the newest pair and reports missing pairs at the frame rate.

#include <algorithm>
#include <functional>
#include <future>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

#include "pipeline/pipeline.hpp"
#include "support/capture/synthetic_cameras.hpp"
#include "support/test_timeout.hpp"

namespace cartvo::pipeline {
namespace {

using std::chrono::milliseconds;
using test::TickingCamera;

capture::Frame leftWall(int index, std::int64_t exposure_ns) {
  return test::wallFrame(index, 0, exposure_ns);
}
capture::Frame rightWall(int index, std::int64_t exposure_ns) {
  return test::wallFrame(index, 12, exposure_ns);
}
capture::Frame noFrame(int /*index*/, std::int64_t /*exposure_ns*/) {
  return {};
}

struct LiveRun {
  std::vector<PairResult> pairs;
  std::vector<NoPair> no_pairs;
  PipelineCounts counts;
  std::string problem;
};

using Condition = std::function<bool(const LiveRun&)>;

/// Runs until the condition holds, or until the test time-out; `on_pair` may be slow.
LiveRun runUntil(const Condition& condition, TickingCamera::Deliver left_delivers,
                 TickingCamera::Deliver right_delivers, const std::function<void()>& on_pair) {
  const calib::Rig rig = test::smallRig();
  PairProcessor processor = test::smallProcessor(rig);
  TickingCamera left(std::move(left_delivers));
  TickingCamera right(std::move(right_delivers));
  Pipeline pipeline(left, right, processor, {rig.left.size, test::kPeriod_ns});
  LiveRun run;
  std::promise<void> condition_holds;
  bool ended = false;
  const auto end = [&] {
    if (!std::exchange(ended, true)) condition_holds.set_value();
  };
  const auto end_if_condition = [&] {
    run.counts = pipeline.counts();
    run.problem = pipeline.problem();
    if (condition(run)) end();
  };
  const auto timer = std::async(std::launch::async, [&] {
    condition_holds.get_future().wait_for(test::kTestTimeout);
    pipeline.stop();
  });
  try {
    // Results between the end and the stop are ignored.
    pipeline.runLive({[&](const PairResult& result) {
                        if (ended) return;
                        run.pairs.push_back(result);
                        on_pair();
                        end_if_condition();
                      },
                      [&](const NoPair& no_pair) {
                        if (ended) return;
                        run.no_pairs.push_back(no_pair);
                        end_if_condition();
                      }});
  } catch (...) {
    end();
    throw;
  }
  timer.wait();
  run.counts = pipeline.counts();
  return run;
}

void quick() {}

/// True if each pair was processed or skipped, except one that may be waiting when the run is stopped.
bool accountsForEveryPair(const PipelineCounts& counts) {
  const std::uint64_t accounted = counts.processed + counts.skipped;
  return accounted == counts.pairs || accounted + 1 == counts.pairs;
}

TEST(PipelineLive, ProcessesPairsOnArrivalAndStops) {
  // On a busy machine so many pairs may be skipped that the motion between some cannot be estimated.
  const LiveRun run = runUntil(
      [](const LiveRun& so_far) { return so_far.pairs.size() > 5 && so_far.pairs.back().estimate.valid; },
      leftWall, rightWall, quick);
  ASSERT_GT(run.pairs.size(), 5u);
  EXPECT_TRUE(
      std::any_of(run.pairs.begin(), run.pairs.end(), [](const auto& pair) { return pair.estimate.valid; }));
  EXPECT_TRUE(accountsForEveryPair(run.counts));
  EXPECT_EQ(run.problem, "");
}

TEST(PipelineLive, SlowProcessingSkipsPairsInsteadOfQueueingThem) {
  // Processing takes five periods. With a queue the n-th result would belong to the n-th pair.
  const LiveRun run = runUntil([](const LiveRun& so_far) { return so_far.pairs.size() > 5; }, leftWall,
                               rightWall, [] { std::this_thread::sleep_for(milliseconds(100)); });
  ASSERT_GT(run.pairs.size(), 5u);
  EXPECT_GT(run.counts.skipped, run.counts.processed) << "four of five pairs are skipped";
  for (std::size_t i = 1; i < run.pairs.size(); ++i) {
    EXPECT_GT(run.pairs[i].left.sequence, run.pairs[i - 1].left.sequence) << "in order";
  }
  EXPECT_GT(run.pairs.back().left.sequence, 2 * run.pairs.size()) << "the newest pair, not the oldest";
}

TEST(PipelineLive, ReducesFeaturesOnSlowComputer) {
  const calib::Rig rig = test::smallRig();
  PairProcessor processor = test::smallProcessor(rig);
  const int configured = processor.features();
  // No computer processes a pair within a frame period of 1 us.
  const auto fast = [](int disparity) {
    return [disparity](int index, std::int64_t /*exposure_ns*/) {
      capture::Frame frame = test::wallFrame(index, disparity, 1'000 * (index + 1));
      frame.arrival_ns = frame.exposure_ns;
      return frame;
    };
  };
  TickingCamera left(fast(0)), right(fast(12));
  Pipeline pipeline(left, right, processor, {rig.left.size, 0});
  std::vector<int> features;
  pipeline.runLive({[&](const PairResult& result) {
                      features.push_back(result.features);
                      if (features.size() == 12) pipeline.stop();
                    },
                    {}});
  ASSERT_FALSE(features.empty());
  EXPECT_EQ(features.front(), configured);
  EXPECT_LT(features.back(), configured);
}

TEST(PipelineLive, ProcessesOnlyNewestPairOfBurst) {
  // Both cameras deliver ten frames at once, about every 200 ms, as over a bad link.
  const auto bursty = [](int disparity) {
    return [disparity](int index, std::int64_t exposure_ns) {
      if (index % 10 == 0) std::this_thread::sleep_for(milliseconds(180));
      return test::wallFrame(index, disparity, exposure_ns);
    };
  };
  const LiveRun run = runUntil([](const LiveRun& so_far) { return so_far.counts.skipped > 0; }, bursty(0),
                               bursty(12), [] { std::this_thread::sleep_for(milliseconds(30)); });
  EXPECT_GT(run.counts.skipped, 0u);
  EXPECT_TRUE(accountsForEveryPair(run.counts));
}

TEST(PipelineLive, ReportsSilentCameraOncePerPeriod) {
  const auto start = std::chrono::steady_clock::now();
  const LiveRun run =
      runUntil([](const LiveRun& so_far) { return so_far.no_pairs.size() >= 25; }, leftWall, noFrame, quick);
  const auto periods =
      (std::chrono::steady_clock::now() - start) / std::chrono::nanoseconds(test::kPeriod_ns);
  EXPECT_TRUE(run.pairs.empty());
  ASSERT_GE(run.no_pairs.size(), 25u);
  EXPECT_LE(run.no_pairs.size(), static_cast<std::size_t>(periods)) << "at most one per period";
  EXPECT_EQ(run.no_pairs.front().cause, NoPairCause::no_frames);
}

TEST(PipelineLive, WrongTimeStampsDoNotPaceMessages) {
  // Stamps in a wrong unit: a period of 20 us. The cameras send 50 pictures a second, none of which pair.
  const auto start = std::chrono::steady_clock::now();
  const auto in_wrong_unit = [](int index, std::int64_t exposure_ns) {
    return leftWall(index, exposure_ns / 1000);
  };
  const auto of_another_time = [](int index, std::int64_t exposure_ns) {
    return rightWall(index, 3'600'000'000'000 + exposure_ns / 1000);
  };
  const LiveRun run = runUntil([](const LiveRun& so_far) { return so_far.no_pairs.size() >= 40; },
                               in_wrong_unit, of_another_time, quick);
  const auto periods =
      (std::chrono::steady_clock::now() - start) / std::chrono::nanoseconds(test::kPeriod_ns);
  EXPECT_TRUE(run.pairs.empty());
  ASSERT_GE(run.no_pairs.size(), 40u);
  EXPECT_LE(run.no_pairs.size(), 2 * static_cast<std::size_t>(periods));
}

TEST(PipelineLive, ReportsCameraThatBecomesSilent) {
  const auto dies = [](int index, std::int64_t exposure_ns) {
    return index < 10 ? rightWall(index, exposure_ns) : capture::Frame{};
  };
  const LiveRun run =
      runUntil([](const LiveRun& so_far) { return !so_far.pairs.empty() && so_far.no_pairs.size() >= 15; },
               leftWall, dies, quick);
  EXPECT_FALSE(run.pairs.empty());
  EXPECT_LE(run.pairs.size(), 10u);
  EXPECT_GE(run.no_pairs.size(), 15u);
}

TEST(PipelineLive, ReportsDamagedFramesAsCauseOfMissingPair) {
  const auto damaged = [](int index, std::int64_t exposure_ns) {
    capture::Frame frame = leftWall(index, exposure_ns);
    frame.status = capture::FrameStatus::damaged;
    return frame;
  };
  const LiveRun run = runUntil(
      [](const LiveRun& so_far) {
        return so_far.counts.dropped_damaged > 5 && !so_far.no_pairs.empty() &&
               so_far.no_pairs.back().cause == NoPairCause::damaged;
      },
      damaged, rightWall, quick);
  EXPECT_TRUE(run.pairs.empty());
  ASSERT_FALSE(run.no_pairs.empty());
  EXPECT_EQ(run.no_pairs.back().cause, NoPairCause::damaged);
}

TEST(PipelineLive, RejectsStreamOfWrongSizeAndNamesIt) {
  const auto large = [](int /*index*/, std::int64_t exposure_ns) {
    capture::Frame frame;
    frame.image = cv::Mat::zeros(576, 704, CV_8UC1);
    frame.exposure_ns = exposure_ns;
    return frame;
  };
  const LiveRun run = runUntil(
      [](const LiveRun& so_far) {
        return so_far.counts.refused_size > 5 && !so_far.no_pairs.empty() &&
               so_far.no_pairs.back().cause == NoPairCause::wrong_size;
      },
      leftWall, large, quick);
  EXPECT_TRUE(run.pairs.empty());
  ASSERT_FALSE(run.no_pairs.empty());
  EXPECT_EQ(run.no_pairs.back().cause, NoPairCause::wrong_size);
  EXPECT_NE(run.problem.find("right camera: the stream is 704x576, but the rig is for 320x240"),
            std::string::npos);
}

TEST(PipelineLive, SourceFailureEndsRunWithItsMessage) {
  const auto broken = [](int index, std::int64_t exposure_ns) -> capture::Frame {
    if (index == 3) throw std::runtime_error("the decoder is broken");
    return rightWall(index, exposure_ns);
  };
  try {
    runUntil([](const LiveRun&) { return false; }, leftWall, broken, quick);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the decoder is broken");
  }
}

TEST(PipelineLive, ReaderOfAbsentCameraMakesProgressStalledReaderDoesNot) {
  const calib::Rig rig = test::smallRig();
  PairProcessor processor = test::smallProcessor(rig);
  std::promise<void> released;
  const std::shared_future<void> release = released.get_future().share();
  TickingCamera left(noFrame);
  TickingCamera right([release](int index, std::int64_t) {
    if (index == 5) release.wait();
    return capture::Frame{};
  });
  Pipeline pipeline(left, right, processor, {rig.left.size, test::kPeriod_ns});
  const auto run = std::async(std::launch::async, [&] { pipeline.runLive({[](const PairResult&) {}, {}}); });
  const auto only_right_stalled = [&] {
    const PipelineProgress progress = pipeline.progress();
    return progress.right_reader > 0.5 && progress.left_reader < 0.25;
  };
  const auto end = std::chrono::steady_clock::now() + test::kTestTimeout;
  bool stalled = false;
  while (!(stalled = only_right_stalled()) && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(milliseconds(20));
  EXPECT_TRUE(stalled) << "the left reader loops without frames, the right one is blocked in a read";
  released.set_value();
  pipeline.stop();
  run.wait();
}

TEST(PipelineProgress, NamesStalledReader) {
  EXPECT_EQ((PipelineProgress{0.2, 4.0}.stalledReader(10.0)), "");
  EXPECT_EQ((PipelineProgress{60.0, 0.1}.stalledReader(10.0)), "left camera's reader");
  EXPECT_EQ((PipelineProgress{0.1, 60.0}.stalledReader(10.0)), "right camera's reader");
}

}  // namespace
}  // namespace cartvo::pipeline
