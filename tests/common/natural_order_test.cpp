// Tests of the order of names with numbers.
#include "common/natural_order.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace cartvo {
namespace {

TEST(NaturalOrder, ComparesNumbersByValue) {
  const std::vector<std::string> expected{"0.png",
                                          "frame1",
                                          "frame2",
                                          "frame002_a",
                                          "frame10",
                                          "frame10_2",
                                          "frame10_11",
                                          "frame99999999999999999998",
                                          "frame99999999999999999999",
                                          "g"};
  std::vector<std::string> sorted = expected;
  std::reverse(sorted.begin(), sorted.end());
  std::sort(sorted.begin(), sorted.end(), NaturalOrder());
  EXPECT_EQ(sorted, expected);
}

TEST(NaturalOrder, ComparesDecimalNumbersByValue) {
  std::vector<std::string> instants{"1403636579.8", "1403636579.763", "1403636580.05", "900.1"};
  std::sort(instants.begin(), instants.end(), NaturalOrder());
  EXPECT_EQ(instants, (std::vector<std::string>{"900.1", "1403636579.763", "1403636579.8", "1403636580.05"}));
}

TEST(NaturalOrder, IsTotal) {
  const NaturalOrder before;
  EXPECT_NE(before("frame1", "frame01"), before("frame01", "frame1"));
  EXPECT_FALSE(before("frame1", "frame1"));
  EXPECT_TRUE(before("", "0"));
}

TEST(NaturalOrder, IgnoresLeadingZerosInNames) {
  EXPECT_EQ(withoutLeadingZeros("frame007_0010"), "frame7_10");
  EXPECT_EQ(withoutLeadingZeros("000"), "0");
  EXPECT_EQ(withoutLeadingZeros("left"), "left");
}

}  // namespace
}  // namespace cartvo
