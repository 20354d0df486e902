// Tests of the statistics and texts of `cartvo watch`: lost messages, restarts, latency, path length.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/command_line/terminal.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/watch/odometry_statistics.hpp"
#include "tools/watch/watch.hpp"

namespace cartvo {
namespace {

constexpr std::int64_t kPeriod_us = 50'000;

odometry_t message(std::int64_t sequence, double x) {
  odometry_t message{};
  message.sequence = sequence;
  message.utime = sequence * kPeriod_us;
  message.arrival_utime = message.utime + 20'000;
  message.publication_utime = message.arrival_utime + 8'000;
  message.status = odometry_t::VALID;
  message.quality = 50;
  message.offset_us = 2'000;
  message.position_world_body[0] = x;
  message.orientation_world_body[0] = 1.0;
  return message;
}

void add(OdometryStatistics& statistics, const odometry_t& odometry) {
  statistics.addMessage(odometry, (odometry.publication_utime + 1'000) * 1'000);
}

TEST(WatchStatistics, ComputesRateLatencyAndPathLength) {
  OdometryStatistics statistics;
  for (int i = 0; i < 21; ++i)
    add(statistics, message(i, 0.1 * i));
  const OdometrySummary summary = statistics.summarise();
  EXPECT_EQ(summary.messages, 21);
  EXPECT_EQ(summary.valid, 21);
  EXPECT_EQ(summary.lost, 0);
  EXPECT_NEAR(summary.frame_rate, 20.0, 1e-9);
  EXPECT_NEAR(summary.latency_p50_ms, 8.0, 1e-9);
  EXPECT_NEAR(summary.age_p99_ms, 29.0, 1e-9);
  EXPECT_NEAR(summary.offset_median_ms, 2.0, 1e-9);
  EXPECT_NEAR(summary.path_length, 2.0, 1e-9);
  EXPECT_EQ(statistics.trajectory().size(), 21u);
  EXPECT_EQ(statistics.trajectory().back().time_ns, 20 * kPeriod_us * 1'000);
}

TEST(WatchStatistics, SeparatesStartupLatency) {
  OdometryStatistics statistics;
  for (int i = 0; i < 60; ++i) {
    odometry_t late = message(i, 0.1 * i);
    if (i < 20) late.publication_utime += 50'000;
    add(statistics, late);
    if (i == 30) {
      EXPECT_TRUE(std::isnan(statistics.summarise().latency_settled_p99_ms));
    }
  }
  const OdometrySummary summary = statistics.summarise();
  EXPECT_NEAR(summary.latency_p99_ms, 58.0, 1e-9);
  EXPECT_NEAR(summary.latency_settled_p99_ms, 8.0, 1e-9);
  const std::string text = summaryText(summary);
  EXPECT_NE(text.find("from 2 s on     p99 8.0 ms"), std::string::npos) << text;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    EXPECT_LT(textColumns(text.substr(begin, end - begin)), 80U) << text;
    begin = end + 1;
  }
}

TEST(WatchStatistics, HasNoLatencyForReplayedRecording) {
  OdometryStatistics statistics;
  odometry_t replayed = message(1, 0.0);
  replayed.publication_utime += 3'600'000'000;
  add(statistics, replayed);
  EXPECT_TRUE(std::isnan(statistics.summarise().latency_p50_ms));
  EXPECT_NE(summaryText(statistics.summarise()).find("a recording was replayed"), std::string::npos);
  EXPECT_NE(liveLine(replayed, 20.0).find("of a recording"), std::string::npos);
  EXPECT_NE(liveLine(message(1, 0.0), 20.0).find("latency   8.0 ms"), std::string::npos);
}

TEST(WatchStatistics, DistinguishesLossesRestartsAndResets) {
  OdometryStatistics statistics;
  add(statistics, message(5, 0.0));
  add(statistics, message(9, 0.1));  // 6, 7, 8 are lost
  odometry_t after_loss = message(10, 0.0);
  after_loss.reset_counter = 1;
  add(statistics, after_loss);
  odometry_t after_restart = message(0, 0.0);
  after_restart.publication_utime = after_loss.publication_utime + kPeriod_us;
  add(statistics, after_restart);
  const OdometrySummary summary = statistics.summarise();
  EXPECT_EQ(summary.lost, 3);
  EXPECT_EQ(summary.resets, 1);
  EXPECT_EQ(summary.restarts, 1);
  EXPECT_NEAR(summary.path_length, 0.1, 1e-9) << "no path across a reset or restart";
}

TEST(WatchStatistics, CountsMessagesWithoutPairSeparately) {
  OdometryStatistics statistics;
  odometry_t blind = message(0, 0.0);
  blind.status = odometry_t::INVALID;
  blind.reasons = odometry_t::REASON_NO_PAIR;
  add(statistics, blind);
  EXPECT_FALSE(statistics.hasPairs());
  EXPECT_EQ(statistics.summarise().no_pair, 1);
  EXPECT_NE(liveLine(blind, 0.0).find("INVALID: no pair"), std::string::npos);
  const std::string bound = "forward velocity is known to 0.42 m/s, alert limit 0.30 m/s";
  EXPECT_EQ(liveLine(blind, 0.0, "", 1000, bound).find(bound), std::string::npos) << "of another message";
  blind.reasons = odometry_t::REASON_BOUND;
  EXPECT_NE(liveLine(blind, 18.0, "", 1000, bound).find("INVALID: bound above its alert limit: " + bound),
            std::string::npos);
  EXPECT_NE(summaryText(statistics.summarise()).find("no pair of frames came"), std::string::npos);
}

TEST(Watch, PrintsProblemAndSelfCheck) {
  health_t health{};
  EXPECT_EQ(adviceText(health), "");
  health.self_check = "calibrate anew";
  EXPECT_EQ(adviceText(health), "self-check: calibrate anew");
  health.problem = "left camera: refused";
  EXPECT_EQ(adviceText(health), "problem: left camera: refused\nself-check: calibrate anew");
  health.problem = health.self_check;
  EXPECT_EQ(adviceText(health), "problem: calibrate anew");
}

TEST(Watch, PrintsSourceOfTheTimeOffset) {
  health_t health{};
  health.right.instant_source = camera_health_t::PICTURES;
  health.clock_deviation_ms = 0.72F;
  EXPECT_EQ(clockText(health), "by pictures ±0.7 ms");
}

TEST(WatchStatistics, IgnoresLateAndRepeatedMessages) {
  OdometryStatistics statistics;
  for (const int sequence : {0, 1, 3, 2, 3, 4})
    add(statistics, message(sequence, 0.1 * sequence));
  const OdometrySummary summary = statistics.summarise();
  EXPECT_EQ(summary.messages, 4);
  EXPECT_EQ(summary.restarts, 0);
  EXPECT_NEAR(summary.path_length, 0.4, 1e-9);
}

TEST(WatchStatistics, FindsTwoDaemonsWhoseSequencesAlternate) {
  OdometryStatistics one_restart, alternating;
  for (int i = 0; i < 4; ++i) {
    odometry_t second = message(i, 0.0);
    second.publication_utime = message(1000 + i, 0.0).publication_utime + 10'000;
    add(alternating, message(1000 + i, 0.0));
    add(alternating, second);
  }
  add(one_restart, message(1000, 0.0));
  odometry_t restarted = message(0, 0.0);
  restarted.publication_utime = message(1040, 0.0).publication_utime;
  add(one_restart, restarted);
  EXPECT_TRUE(alternating.hasTwoPublishers());
  EXPECT_FALSE(one_restart.hasTwoPublishers());
  EXPECT_NE(summaryText(alternating.summarise()).find("two daemons publish"), std::string::npos);
}

TEST(WatchText, NamesTheChannelsOfAnotherDefinition) {
  EXPECT_EQ(foreignDefinitionText(false, false), "");
  EXPECT_NE(foreignDefinitionText(true, false).find("CARTVO_ODOMETRY, but of another definition"),
            std::string::npos);
  EXPECT_NE(foreignDefinitionText(true, true).find("CARTVO_ODOMETRY and CARTVO_HEALTH"), std::string::npos);
}

TEST(WatchStatistics, CountsSenselessMessagesApart) {
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kSmallest = std::numeric_limits<std::int64_t>::min();
  OdometryStatistics statistics;
  add(statistics, message(0, 0.0));
  for (const std::int64_t extreme : {kLargest, kSmallest}) {
    for (std::int64_t odometry_t::*const member : {&odometry_t::utime, &odometry_t::arrival_utime,
                                                   &odometry_t::publication_utime, &odometry_t::sequence}) {
      odometry_t wrong = message(1, 0.0);
      wrong.*member = extreme;
      statistics.addMessage(wrong, 1'000'000'000);
    }
  }
  odometry_t not_finite = message(1, std::nan(""));
  add(statistics, not_finite);
  odometry_t contradicted = message(2, 0.1);
  contradicted.reasons = odometry_t::REASON_HIGH_RESIDUAL;
  add(statistics, contradicted);
  odometry_t huge = message(3, 0.1);
  huge.velocity_body[0] = 1e300;
  add(statistics, huge);
  EXPECT_LT(liveLine(huge, 18.0).size(), 120u);
  add(statistics, message(4, 0.4));
  const OdometrySummary summary = statistics.summarise();
  EXPECT_EQ(summary.senseless, 11);
  EXPECT_EQ(summary.valid, 2);
  EXPECT_TRUE(std::isfinite(summary.path_length));
  EXPECT_NE(summaryText(summary).find("11 messages with impossible numbers"), std::string::npos);
}

TEST(WatchText, LiveLineFitsTheTerminal) {
  odometry_t valid = message(1, 0.0);
  valid.velocity_body[0] = 2.94;
  valid.features = 978;
  const std::string clocks = "by sender reports ±0.7 ms";
  const std::string full = liveLine(valid, 18.0, clocks);
  EXPECT_NE(full.find("features   978"), std::string::npos);
  EXPECT_NE(full.find(clocks), std::string::npos);
  for (const std::size_t columns : {129u, 99u, 79u, 59u, 39u, 20u, 3u}) {
    const std::string line = liveLine(valid, 18.0, clocks, columns);
    EXPECT_LE(textColumns(line), columns) << line;
    if (columns >= 39) {
      EXPECT_NE(line.find("speed   2.94 m/s"), std::string::npos) << line;
      EXPECT_NE(line.find("valid"), std::string::npos) << line;
    }
  }
  EXPECT_EQ(liveLine(valid, 18.0, clocks, 79).find("features"), std::string::npos);
  valid.status = odometry_t::INVALID;
  valid.reasons = (1 << 16) - 1;
  EXPECT_LE(textColumns(liveLine(valid, 18.0, clocks, 79)), 79u);
}

TEST(ProgressLine, FitsTheTerminal) {
  EXPECT_EQ(progressLine(10, 40, "pairs", 5.0, 199),
            "[#######.......................] 10/40 pairs, 2.0/s, 0:15 left");
  EXPECT_EQ(progressLine(10, 40, "pairs", 5.0, 40), "[##......] 10/40 pairs, 2.0/s, 0:15 left");
  EXPECT_EQ(progressLine(10, 40, "pairs", 5.0, 30), "[#....] 10/40 pairs, 0:15 left");
  EXPECT_EQ(progressLine(10, 40, "pairs", 5.0, 29), "10/40 pairs, 0:15 left");
  EXPECT_EQ(progressLine(10, 0, "pairs", 5.0, 79), "10 pairs, 2.0/s");
  EXPECT_EQ(progressLine(2, 10, "s", 5.0, 30), "[##........] 2/10 s, 0:08 left") << "time has no rate";
  for (std::size_t columns = 0; columns < 100; ++columns)
    EXPECT_LE(textColumns(progressLine(7, 40, "pictures searched for the offset", 5.0, columns)), columns);
}

}  // namespace
}  // namespace cartvo
