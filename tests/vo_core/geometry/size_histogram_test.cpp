// Compares the standard deviation from a histogram with the one from all errors.
#include "vo_core/geometry/size_histogram.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::vo {
namespace {

TEST(SizeHistogram, EstimatesTheStddevOfErrorsOfAnySize) {
  test::Noise noise(3);
  for (const double stddev : {0.003, 0.7, 1.0, 1.4, 90.0}) {
    SizeHistogram histogram;
    std::vector<double> sizes;
    for (int i = 0; i < 4000; ++i) {
      sizes.push_back(std::abs(stddev * noise.gaussian()));
      histogram.add(sizes.back());
    }
    EXPECT_EQ(histogram.count(), 4000);
    EXPECT_NEAR(histogram.stddev(), stddevFromMedian(sizes), 0.003 * stddev);
  }
}

TEST(SizeHistogram, IsRobustAgainstOutliers) {
  SizeHistogram histogram;
  for (int i = 0; i < 90; ++i)
    histogram.add(1.0);
  for (int i = 0; i < 10; ++i)
    histogram.add(i < 5 ? 1e300 : 0.0);
  EXPECT_NEAR(histogram.stddev(), 1.0 / kMedianOfNormal, 0.02);
  histogram.clear();
  EXPECT_EQ(histogram.count(), 0);
}

TEST(SizeHistogram, AcceptsZeroInfinityAndNan) {
  SizeHistogram histogram;
  histogram.add(0.0);
  histogram.add(INFINITY);
  histogram.add(std::abs(NAN));
  EXPECT_EQ(histogram.count(), 3);
  EXPECT_GT(histogram.stddev(), 1000.0);
}

}  // namespace
}  // namespace cartvo::vo
