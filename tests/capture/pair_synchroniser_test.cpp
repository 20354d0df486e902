// Pairing of frames by their instants, with hand-made and with random sequences.

#include "capture/pair_synchroniser.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo::capture {
namespace {

constexpr std::int64_t kPeriod = 50'000'000;

Frame frameAt(std::int64_t instant_ns, std::uint64_t sequence = 0) {
  Frame frame;
  frame.exposure_ns = instant_ns;
  frame.sequence = sequence;
  frame.instant_source = InstantSource::sender_report;
  return frame;
}

Frame damagedAt(std::int64_t instant_ns) {
  Frame frame = frameAt(instant_ns);
  frame.status = FrameStatus::damaged;
  return frame;
}

PairSynchroniser nominal() {
  return PairSynchroniser({.period_ns = kPeriod, .queue_length = 16, .restart_after = 8});
}

std::vector<FramePair> popAll(PairSynchroniser& synchroniser) {
  std::vector<FramePair> pairs;
  while (std::optional<FramePair> pair = synchroniser.pop())
    pairs.push_back(std::move(*pair));
  return pairs;
}

std::uint64_t accounted(const PairingCounts& c) {
  return c.paired + c.no_partner + c.damaged + c.out_of_order + c.overflow + c.clock_restarted;
}

TEST(PairSynchroniser, PairsFramesAtMostHalfAPeriodApart) {
  PairSynchroniser synchroniser = nominal();
  synchroniser.push(CameraSide::left, frameAt(0));
  EXPECT_FALSE(synchroniser.pop());
  synchroniser.push(CameraSide::right, frameAt(kPeriod / 2));
  const std::optional<FramePair> pair = synchroniser.pop();
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->offsetNs(), kPeriod / 2);
}

TEST(PairSynchroniser, DoesNotPairFramesMoreThanHalfAPeriodApart) {
  PairSynchroniser synchroniser = nominal();
  synchroniser.push(CameraSide::left, frameAt(0));
  synchroniser.push(CameraSide::right, frameAt(kPeriod / 2 + 1));
  EXPECT_FALSE(synchroniser.pop());
  EXPECT_EQ(synchroniser.counts(CameraSide::left).no_partner, 1U);
  synchroniser.push(CameraSide::left,
                    frameAt(kPeriod));  // within half a period of the waiting right frame
  const std::optional<FramePair> pair = synchroniser.pop();
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->offsetNs(), kPeriod / 2 + 1 - kPeriod);
}

TEST(PairSynchroniser, DropsDamagedFrames) {
  PairSynchroniser synchroniser = nominal();
  synchroniser.push(CameraSide::left, damagedAt(0));
  synchroniser.push(CameraSide::right, frameAt(0));
  synchroniser.push(CameraSide::left, frameAt(kPeriod));
  synchroniser.push(CameraSide::right, frameAt(kPeriod));
  const std::vector<FramePair> pairs = popAll(synchroniser);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].left.exposure_ns, kPeriod);
  EXPECT_EQ(synchroniser.counts(CameraSide::left).damaged, 1U);
  EXPECT_EQ(synchroniser.counts(CameraSide::right).no_partner, 1U);
}

TEST(PairSynchroniser, DropsDuplicateAndBackwardInstants) {
  PairSynchroniser synchroniser = nominal();
  for (const std::int64_t instant : {std::int64_t{0}, kPeriod, kPeriod, kPeriod / 3, 2 * kPeriod}) {
    synchroniser.push(CameraSide::left, frameAt(instant));
  }
  for (const std::int64_t instant : {std::int64_t{0}, kPeriod, 2 * kPeriod}) {
    synchroniser.push(CameraSide::right, frameAt(instant));
  }
  EXPECT_EQ(popAll(synchroniser).size(), 3U);
  EXPECT_EQ(synchroniser.counts(CameraSide::left).out_of_order, 2U);
}

TEST(PairSynchroniser, RestartsAfterClockWasSetBack) {
  PairSynchroniser synchroniser = nominal();
  const std::int64_t set_back_ns = 3'600'000'000'000;
  const auto push_both = [&](std::int64_t instant) {
    synchroniser.push(CameraSide::left, frameAt(instant));
    synchroniser.push(CameraSide::right, frameAt(instant + 1000));
    return popAll(synchroniser);
  };
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(push_both(set_back_ns + i * kPeriod).size(), 1U);
  int pairs = 0;
  for (int i = 0; i < 20; ++i)
    pairs += static_cast<int>(push_both(i * kPeriod).size());
  EXPECT_EQ(pairs, 13);  // the first seven of the earlier frames are dropped
}

TEST(PairSynchroniser, LimitsQueueWhileOtherCameraSendsNothing) {
  PairSynchroniser synchroniser = nominal();
  for (int i = 0; i < 100; ++i) {
    synchroniser.push(CameraSide::left, frameAt(i * kPeriod));
    if (i < 10 || i >= 90) synchroniser.push(CameraSide::right, frameAt(i * kPeriod + 3));
  }
  const std::vector<FramePair> pairs = popAll(synchroniser);
  EXPECT_EQ(synchroniser.counts(CameraSide::left).overflow, 84U);
  EXPECT_FALSE(pairs.empty());
  for (const FramePair& pair : pairs)
    EXPECT_EQ(pair.offsetNs(), 3);
}

TEST(PairSynchroniser, ResumesPairingWhenStalledCameraReturns) {
  PairSynchroniser synchroniser = nominal();
  int pairs = 0;
  for (int i = 0; i < 100; ++i) {
    synchroniser.push(CameraSide::left, frameAt(i * kPeriod));
    if (i < 10 || i >= 90) synchroniser.push(CameraSide::right, frameAt(i * kPeriod + 3));
    pairs += static_cast<int>(popAll(synchroniser).size());
  }
  EXPECT_EQ(pairs, 20);
}

TEST(PairSynchroniser, PairsOnlyEqualInstantsUntilPeriodIsEstimated) {
  PairSynchroniser synchroniser({});
  synchroniser.push(CameraSide::left, frameAt(0));
  synchroniser.push(CameraSide::right, frameAt(0));
  EXPECT_TRUE(synchroniser.pop());
  synchroniser.push(CameraSide::left, frameAt(kPeriod));
  synchroniser.push(CameraSide::right, frameAt(kPeriod + 1));
  EXPECT_FALSE(synchroniser.pop());
  for (int i = 2; i < 6; ++i) {
    synchroniser.push(CameraSide::left, frameAt(i * kPeriod));
    synchroniser.push(CameraSide::right, frameAt(i * kPeriod + 1));
  }
  EXPECT_EQ(popAll(synchroniser).size(), 5U);
  EXPECT_NEAR(static_cast<double>(synchroniser.periodNs()), static_cast<double>(kPeriod), 2.0);
}

TEST(PairSynchroniser, PeriodOfUnevenInstantsIsTheirMean) {
  constexpr double kTrue = 1e9 / 18.0;
  const auto rounded = [](int i) { return std::llround(kTrue * i / 10e6) * 10'000'000; };
  const auto late_key_pictures = [](int i) {
    return std::llround(kTrue * i) + (i % 18 == 0 ? 20'000'000 : 0);
  };
  const auto every_third_lost = [](int i) { return std::llround(kTrue * (i + i / 2)); };
  for (const std::function<std::int64_t(int)>& instant :
       {std::function<std::int64_t(int)>(rounded), std::function<std::int64_t(int)>(late_key_pictures),
        std::function<std::int64_t(int)>(every_third_lost)}) {
    FramePeriodEstimator estimator;
    for (int i = 0; i < 100; ++i)
      estimator.add(instant(i));
    EXPECT_NEAR(static_cast<double>(estimator.periodNs()), kTrue, 0.03 * kTrue);
  }
}

TEST(PairSynchroniser, DropsFramesThatWaitForFinishedCamera) {
  PairSynchroniser synchroniser = nominal();
  synchroniser.push(CameraSide::left, frameAt(0));
  synchroniser.push(CameraSide::left, frameAt(kPeriod));
  synchroniser.push(CameraSide::right, frameAt(0));
  synchroniser.finish(CameraSide::right);
  EXPECT_EQ(popAll(synchroniser).size(), 1U);
  EXPECT_EQ(synchroniser.counts(CameraSide::left).no_partner, 1U);
}

TEST(PairSynchroniser, RejectsInvalidSettings) {
  EXPECT_THROW(PairSynchroniser({.period_ns = -1, .queue_length = 1, .restart_after = 1}),
               std::invalid_argument);
  EXPECT_THROW(PairSynchroniser({.period_ns = 0, .queue_length = 0, .restart_after = 1}),
               std::invalid_argument);
  EXPECT_THROW(PairSynchroniser({.period_ns = 0, .queue_length = 1, .restart_after = 0}),
               std::invalid_argument);
}

/// Faults of two free-running cameras.
struct Scenario {
  double skew = 0.0;           ///< right against left, relative
  std::int64_t offset_ns = 0;  ///< at the start
  double jitter_ns = 0.0;      ///< standard deviation of each instant
  double drop = 0.0;           ///< probability that a frame is lost
  double damage = 0.0;         ///< probability that it is damaged
  int frames = 0;
  std::int64_t given_period_ns = kPeriod;
};

struct Outcome {
  std::vector<FramePair> pairs;
  PairingCounts left, right;
};

Outcome run(const Scenario& scenario, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> jitter(0.0, 1.0);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  struct Event {
    std::int64_t arrival;
    CameraSide side;
    Frame frame;
  };
  std::vector<Event> events;
  for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
    std::int64_t last_arrival = 0;
    for (int i = 0; i < scenario.frames; ++i) {
      const double stretch = side == CameraSide::right ? 1.0 + scenario.skew : 1.0;
      const std::int64_t begin = side == CameraSide::right ? scenario.offset_ns : 0;
      const double instant = i * static_cast<double>(kPeriod) * stretch + scenario.jitter_ns * jitter(random);
      Frame frame = frameAt(begin + static_cast<std::int64_t>(instant), static_cast<std::uint64_t>(i));
      if (chance(random) < scenario.damage) frame.status = FrameStatus::damaged;
      const bool lost = chance(random) < scenario.drop;
      const auto delay = static_cast<std::int64_t>(chance(random) * 2.0 * static_cast<double>(kPeriod));
      last_arrival = std::max(last_arrival, frame.exposure_ns + delay);
      if (!lost) events.push_back({last_arrival, side, std::move(frame)});
    }
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const Event& a, const Event& b) { return a.arrival < b.arrival; });
  PairSynchroniser synchroniser(
      {.period_ns = scenario.given_period_ns, .queue_length = 16, .restart_after = 8});
  Outcome outcome;
  const auto collect = [&] {
    while (std::optional<FramePair> pair = synchroniser.pop())
      outcome.pairs.push_back(std::move(*pair));
  };
  for (Event& event : events) {
    synchroniser.push(event.side, std::move(event.frame));
    collect();
  }
  synchroniser.finish(CameraSide::left);
  synchroniser.finish(CameraSide::right);
  collect();
  outcome.left = synchroniser.counts(CameraSide::left);
  outcome.right = synchroniser.counts(CameraSide::right);
  return outcome;
}

void expectConsistent(const Outcome& outcome) {
  std::set<std::uint64_t> left;
  std::set<std::uint64_t> right;
  std::int64_t last_left = -kPeriod * 100;
  std::int64_t last_right = last_left;
  for (const FramePair& pair : outcome.pairs) {
    EXPECT_LE(std::abs(pair.offsetNs()), kPeriod * 5 / 8) << "instants without uncertainty: an eighth more";
    EXPECT_TRUE(left.insert(pair.left.sequence).second) << "a left frame was used twice";
    EXPECT_TRUE(right.insert(pair.right.sequence).second) << "a right frame was used twice";
    EXPECT_GT(pair.left.exposure_ns, last_left);
    EXPECT_GT(pair.right.exposure_ns, last_right);
    EXPECT_EQ(pair.left.status, FrameStatus::good);
    EXPECT_EQ(pair.right.status, FrameStatus::good);
    last_left = pair.left.exposure_ns;
    last_right = pair.right.exposure_ns;
  }
  EXPECT_EQ(accounted(outcome.left), outcome.left.received);
  EXPECT_EQ(accounted(outcome.right), outcome.right.received);
}

TEST(PairSynchroniser, StaysConsistentUnderRandomJitterDropsAndDamage) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Scenario scenario;
    scenario.frames = 200;
    scenario.offset_ns = static_cast<std::int64_t>(seed) * kPeriod / 100 - kPeriod;
    scenario.jitter_ns = seed % 5 * 2e6;
    scenario.drop = seed % 4 * 0.1;
    scenario.damage = seed % 3 * 0.05;
    scenario.given_period_ns = seed % 2 == 0 ? kPeriod : 0;
    const Outcome outcome = run(scenario, seed);
    if (scenario.given_period_ns != 0) expectConsistent(outcome);
    EXPECT_GT(outcome.pairs.size(), 40U) << "seed " << seed;
    EXPECT_EQ(accounted(outcome.left), outcome.left.received);
  }
}

TEST(PairSynchroniser, EstimatesPeriodDespiteDrops) {
  Scenario scenario;
  scenario.frames = 1000;
  scenario.offset_ns = kPeriod / 3;
  scenario.drop = 0.3;
  scenario.given_period_ns = 0;
  const Outcome outcome = run(scenario, 7);
  expectConsistent(outcome);
  EXPECT_NEAR(static_cast<double>(outcome.pairs.size()), 1000 * 0.7 * 0.7, 50.0);
}

TEST(PairSynchroniser, LosesOneFramePerPeriodOfOffsetSweep) {
  Scenario scenario;  // 50 ppm at 20 fps: one period in 20,000 frames, two and a half in this test
  scenario.frames = 50000;
  scenario.skew = 50e-6;
  const Outcome outcome = run(scenario, 1);
  expectConsistent(outcome);
  EXPECT_GE(outcome.pairs.size(), 49990U);
  EXPECT_LE(outcome.left.no_partner + outcome.right.no_partner, 12U);
  std::size_t gap = 0;
  for (std::size_t i = 1; i < outcome.pairs.size(); ++i) {
    gap = std::max(
        gap, static_cast<std::size_t>(outcome.pairs[i].left.sequence - outcome.pairs[i - 1].left.sequence));
  }
  EXPECT_LE(gap, 2U);
}

/// How often the right frame that the offset belongs to changes from after the left frame to before it, or
/// back.
int partnerChanges(const Outcome& outcome) {
  int changes = 0;
  for (std::size_t i = 1; i < outcome.pairs.size(); ++i)
    if ((outcome.pairs[i].offsetNs() > 0) != (outcome.pairs[i - 1].offsetNs() > 0)) ++changes;
  return changes;
}

TEST(PairSynchroniser, KeepsPartnersAtHalfAPeriodOffsetWithJitter) {
  for (const std::int64_t offset :
       {-kPeriod / 2, kPeriod / 2 - 1'000'000, kPeriod / 2, kPeriod / 2 + 1'000'000})
    for (unsigned seed = 0; seed < 10; ++seed) {
      Scenario scenario;
      scenario.frames = 1000;
      scenario.offset_ns = offset;
      scenario.jitter_ns = 1e6;
      const Outcome outcome = run(scenario, seed);
      expectConsistent(outcome);
      EXPECT_GE(outcome.pairs.size(), 999U) << "the first pair decides on the partner";
      EXPECT_EQ(partnerChanges(outcome), 0) << offset << ", seed " << seed;
    }
}

TEST(PairSynchroniser, ChangesPartnersOnceWhereASweepWithJitterPassesHalfAPeriod) {
  Scenario scenario;  // sweeps a period and a half, passing half a period twice
  scenario.frames = 15000;
  scenario.skew = 100e-6;
  scenario.jitter_ns = 1e6;
  const Outcome outcome = run(scenario, 5);
  expectConsistent(outcome);
  EXPECT_EQ(outcome.left.no_partner + outcome.right.no_partner, 2U) << "one, and one at the end";
  EXPECT_GE(outcome.pairs.size(), 14998U);
}

TEST(PairSynchroniser, KeepsPartnersLongerWhereInstantsAreUncertain) {
  for (const std::int64_t stddev : {std::int64_t{0}, std::int64_t{2'500'000}, kPeriod}) {
    PairSynchroniser synchroniser = nominal();
    const auto offset_after = [&](int i, std::int64_t offset) {
      for (const CameraSide side : {CameraSide::left, CameraSide::right}) {
        Frame frame = frameAt(i * kPeriod + (side == CameraSide::right ? offset : 0));
        frame.exposure_stddev_ns = stddev;
        synchroniser.push(side, std::move(frame));
      }
      const std::vector<FramePair> pairs = popAll(synchroniser);
      return pairs.empty() ? std::int64_t{0} : pairs.back().offsetNs();
    };
    const auto three_stddevs = static_cast<std::int64_t>(3.0 * std::sqrt(2.0) * static_cast<double>(stddev));
    const std::int64_t limit = kPeriod / 2 + std::clamp(three_stddevs, kPeriod / 8, kPeriod / 4);
    EXPECT_EQ(offset_after(0, kPeriod / 2), kPeriod / 2);
    EXPECT_EQ(offset_after(1, limit - 1), limit - 1);
    EXPECT_EQ(offset_after(2, limit + 2), 0) << "the other frame is clearly nearer";
    EXPECT_EQ(offset_after(3, limit + 2), limit + 2 - kPeriod);
    EXPECT_EQ(offset_after(4, limit - 2), limit + 2 - kPeriod) << "of the right frame that waited";
    EXPECT_EQ(offset_after(5, limit - 2), limit - 2 - kPeriod) << "the new partner is kept";
    EXPECT_EQ(synchroniser.counts(CameraSide::left).no_partner, 1U);
    EXPECT_EQ(synchroniser.counts(CameraSide::right).no_partner, 0U);
  }
}

TEST(PairSynchroniser, KeepsPartnersAfterALostFrameAtHalfAPeriodOffset) {
  PairSynchroniser synchroniser = nominal();
  int pairs = 0;
  for (int i = 0; i < 20; ++i) {
    synchroniser.push(CameraSide::left, frameAt(i * kPeriod));
    if (i != 10)
      synchroniser.push(CameraSide::right, frameAt(i * kPeriod + kPeriod / 2 + (i > 0 ? 1000 : 0)));
    for (const FramePair& pair : popAll(synchroniser)) {
      ++pairs;
      EXPECT_GT(pair.offsetNs(), 0);
    }
  }
  EXPECT_EQ(pairs, 19);
  EXPECT_EQ(synchroniser.counts(CameraSide::left).no_partner, 1U);
}

TEST(FramePair, OffsetVarianceIsSumOfBothVariances) {
  FramePair pair;
  EXPECT_EQ(pair.offsetStddevNs(), 0.0);
  pair.left.exposure_stddev_ns = 3'000'000;
  pair.right.exposure_stddev_ns = 4'000'000;
  EXPECT_DOUBLE_EQ(pair.offsetStddevNs(), 5e6);
}

}  // namespace
}  // namespace cartvo::capture
