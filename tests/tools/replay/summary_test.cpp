// Summary of a replay: faults, and the reasons of pairs that are not valid.
#include "tools/replay/summary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cartvo {
namespace {

using ::testing::HasSubstr;

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

}  // namespace
}  // namespace cartvo
