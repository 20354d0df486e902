// Problems of light in a part of a replay.
#include "tools/replay/light_by_seconds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/pipeline/valid_result.hpp"

namespace cartvo {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::StartsWith;

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
