// Pairs that are kept for the checks, consecutive and spread ones.
#include "tools/doctor/cameras/kept_pairs.hpp"

#include <gtest/gtest.h>

namespace cartvo::doctor {
namespace {

/// Pairs 0.05 s apart.
KeptPairs keep(int count, cv::Size size) {
  PairKeeper keeper;
  for (int i = 0; i < count; ++i) {
    capture::FramePair pair;
    pair.left.image = cv::Mat::zeros(size, CV_8UC1);
    pair.right.image = cv::Mat::zeros(size, CV_8UC1);
    pair.left.exposure_ns = pair.right.exposure_ns = i * 50'000'000LL;
    keeper.add(std::move(pair));
  }
  return keeper.take();
}

double exposure(const capture::FramePair& pair) {
  return 1e-9 * static_cast<double>(pair.left.exposure_ns);
}

TEST(PairKeeper, KeepsAllOfAFew) {
  const KeptPairs kept = keep(20, {8, 8});
  EXPECT_EQ(kept.consecutive.size(), 20U);
  EXPECT_EQ(kept.spread.size(), 4U);
}

TEST(PairKeeper, SpreadsPairsOverTheWholeTime) {
  const KeptPairs kept = keep(2400, {8, 8});
  ASSERT_GE(kept.spread.size(), 40U);
  ASSERT_LE(kept.spread.size(), 80U);
  EXPECT_EQ(exposure(kept.spread.front()), 0.0);
  const double distance = exposure(kept.spread[1]);
  for (std::size_t i = 1; i < kept.spread.size(); ++i)
    EXPECT_NEAR(exposure(kept.spread[i]) - exposure(kept.spread[i - 1]), distance, 1e-6);
  EXPECT_GE(exposure(kept.spread.back()), 119.95 - distance - 1e-6);
}

TEST(PairKeeper, KeepsTheLastConsecutivePairs) {
  const KeptPairs kept = keep(2400, {8, 8});
  ASSERT_EQ(kept.consecutive.size(), 40U);
  EXPECT_DOUBLE_EQ(exposure(kept.consecutive.front()), 118.0);
  EXPECT_DOUBLE_EQ(exposure(kept.consecutive.back()), 119.95);
}

TEST(PairKeeper, KeepsFewerLargePairs) {
  const KeptPairs kept = keep(120, {4000, 1500});  // 12 MB each
  EXPECT_EQ(kept.consecutive.size(), 12U);
  EXPECT_LE(kept.spread.size(), 25U);
  EXPECT_GE(kept.spread.size(), 12U);
}

}  // namespace
}  // namespace cartvo::doctor
