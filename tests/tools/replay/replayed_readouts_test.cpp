// The readouts in the summary of a replay.
#include <gtest/gtest.h>

#include "tools/replay/summary.hpp"

namespace cartvo {
namespace {

TEST(ReplaySummary, HasTheReadoutsOfTheRigAndTheLastEstimates) {
  Replay replay;
  replay.rig.rig.left.readout = 0.03;
  replay.pairs.resize(3);
  replay.pairs[1].readouts = vo::ReadoutEstimates{{0.0321, 1e-4}, {-0.0384, 2e-4}};
  const nlohmann::ordered_json readouts = replaySummary({}, replay)["readouts"];
  EXPECT_NEAR(readouts["rig_left_ms"].get<double>(), 30.0, 1e-9);
  EXPECT_TRUE(readouts["rig_right_ms"].is_null());
  EXPECT_NEAR(readouts["left_ms"]["value"].get<double>(), 32.1, 1e-9);
  EXPECT_NEAR(readouts["right_ms"]["deviation"].get<double>(), 0.2, 1e-9);
}

}  // namespace
}  // namespace cartvo
