// Summary of a replay: faults, and the reasons of pairs that are not valid. Tests of the self-check of a
// whole drive. Problems of light in a part of a replay.
#include "tools/replay/summary.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/pipeline/valid_result.hpp"
#include "tools/replay/light_by_seconds.hpp"

namespace cartvo {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

TEST(ReplaySummary, NamesGrossFaultsOfTheRig) {
  Replay replay;
  replay.pairs.resize(4);
  for (std::size_t i = 1; i < replay.pairs.size(); ++i) {
    replay.pairs[i].reasons = vo::OdometryReason::wrong_stereo_geometry;
    replay.pairs[i].stereo_fault = i == 1 ? vo::StereoFault::suspected : vo::StereoFault::swapped;
  }
  const nlohmann::ordered_json summary = replaySummary({}, replay);
  const nlohmann::ordered_json expected{{"swapped", {{"first_pair", 2}, {"pairs", 2}}}};
  EXPECT_EQ(summary["stereo_faults"], expected);
  EXPECT_EQ(summary["invalid_by_reason"]["wrong_stereo_geometry"], 3);
}

TEST(ReplaySummary, NamesTheReasonIfNothingIsValid) {
  Replay replay;
  replay.pairs.resize(3);
  replay.pairs[0].reasons.add(vo::OdometryReason::first_pair);
  EXPECT_THAT(nothingValidText(replay), HasSubstr("none of the 3 pairs is valid; first_pair in 1"));
  replay.pairs[1].reasons.add(vo::OdometryReason::time_step);
  EXPECT_THAT(nothingValidText(replay),
              HasSubstr("time_step in 1: the instants of the pairs are too far apart"));
  replay.pairs[2].valid = true;
  EXPECT_EQ(nothingValidText(replay), "");
}

TEST(ReplaySummary, CountsPairsWithABoundAboveItsAlertLimit) {
  Replay replay;
  replay.pairs.resize(4);
  replay.pairs[0].reasons.add(vo::OdometryReason::first_pair);
  for (const std::size_t pair : {1U, 2U})
    replay.pairs[pair].message.reasons = odometry_t::REASON_BOUND;
  replay.pairs[2].reasons.add(vo::OdometryReason::zero_velocity);
  replay.pairs[3].valid = true;
  EXPECT_EQ(invalidPairsText(replay), "not valid: 1 first pair, 2 bound above its alert limit\n");
  const nlohmann::ordered_json expected{{"first_pair", 1}, {"bound", 2}};
  EXPECT_EQ(replaySummary({}, replay)["invalid_by_reason"], expected);
  replay.pairs.pop_back();
  EXPECT_THAT(nothingValidText(replay),
              HasSubstr("bound in 2: the motion is not known as well as --alert-limits"));
}

constexpr double kPeriod = 0.05;  // s

TEST(DriveSelfCheck, NamesAFaultThatHasEnded) {
  DriveSelfCheck check;
  for (int i = 0; i < 200; ++i)
    check.add(i >= 40 && i < 100 ? "turned by " + std::to_string(0.01 * i) + " deg" : "", kPeriod * i);
  EXPECT_EQ(check.sentence(), "turned by 0.990000 deg (from 2.0 to 5.0 s)");
}

TEST(DriveSelfCheck, NamesTheLongestFirstAndNoMoment) {
  DriveSelfCheck check;
  for (int i = 0; i < 200; ++i)
    check.add(i < 10 ? "moment" : i < 60 ? "short" : "long", kPeriod * i);
  EXPECT_EQ(check.sentence(), "long; short (from 0.5 to 3.0 s)");
}

TEST(DriveSelfCheck, SaysNothingOfAGoodDrive) {
  DriveSelfCheck check;
  EXPECT_EQ(check.sentence(), "");
  check.add("", 0.0);
  EXPECT_EQ(check.sentence(), "");
}

TEST(LightBySeconds, NamesALensThatIsCoveredForAPartOfTheDrive) {
  LightBySeconds light;
  pipeline::PairResult result = test::validResult();
  const pipeline::PictureLight day{}, covered{8.0, 0.9, 0.0, 0.0};
  for (int pair = 0; pair < 80; ++pair) {  // 8 s
    const bool is_covered = pair >= 50 && pair < 70;
    result.estimate.exposure_ns = pair * std::int64_t{100'000'000};
    result.light = {day, is_covered ? covered : day};
    odometry_t message{};
    message.status = is_covered ? odometry_t::INVALID : odometry_t::VALID;
    if (is_covered) message.reasons = odometry_t::REASON_TOO_FEW_MATCHES;
    light.add(result, message);
  }
  EXPECT_THAT(light.consumeProblems(),
              ElementsAre(AllOf(StartsWith("right camera: the picture is dark"), EndsWith(" (2 of 8 s)"))));
}

}  // namespace
}  // namespace cartvo
