// Tests of medians, quantiles and percentiles.
#include "common/statistics.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

TEST(Statistics, MedianOfAnEvenNumberIsTheUpperMiddleValue) {
  EXPECT_EQ(medianOf({7.0}), 7.0);
  EXPECT_EQ(medianOf({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(medianOf({4.0, 1.0, 3.0, 2.0}), 3.0);
}

TEST(Statistics, MedianAndQuantileOfNanosecondsAreExact) {
  std::vector<std::int64_t> values{9'007'199'254'740'993, 1, 9'007'199'254'740'995};  // a double has 53 bits
  EXPECT_EQ(quantile(values, 0.5), 9'007'199'254'740'993);
  EXPECT_EQ(median(values), 9'007'199'254'740'993);
}

TEST(Statistics, QuantileIsTheLowerValueBetweenTwoRanks) {
  const std::vector<double> values{40.0, 10.0, 30.0, 20.0};
  EXPECT_EQ(quantile(values, 0.0), 10.0);
  EXPECT_EQ(quantile(values, 0.5), 20.0);
  EXPECT_EQ(quantile(values, 1.0), 40.0);
}

TEST(Statistics, PercentileIsTheNearestRank) {
  const std::vector<double> values{4.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(percentile(values, 0.0), 1.0);
  EXPECT_EQ(percentile(values, 0.5), 2.0);
  EXPECT_EQ(percentile(values, 0.51), 3.0);
  EXPECT_EQ(percentile(values, 1.0), 4.0);
  EXPECT_TRUE(std::isnan(percentile({}, 0.5)));
}

TEST(Statistics, StddevFromMedianIgnoresOutliers) {
  // The median magnitude of a normal distribution of standard deviation 2 is 1.349.
  std::vector<double> magnitudes{1.349, 0.5, 1e9, 1.0, 2.0};
  EXPECT_NEAR(stddevFromMedian(magnitudes), 2.0, 1e-3);
}

}  // namespace
}  // namespace cartvo
