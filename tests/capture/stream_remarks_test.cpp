// Texts of what a camera sends and what is left out.
#include "capture/stream_remarks.hpp"

#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cartvo::capture {
namespace {

using ::testing::HasSubstr;
using Kind = StreamRemarks::Kind;

TEST(StreamRemarks, NameTheFirstOfWhatACameraNeverSends) {
  StreamRemarks remarks;
  EXPECT_EQ(remarks.text(), "");
  remarks.setTotal(Kind::channel, 1, "2");
  EXPECT_THAT(remarks.text(), HasSubstr("packets on channel 2"));
}

TEST(StreamRemarks, NameLostPicturesFromTheHundredthOn) {
  for (const auto& [kind, text] : {std::pair{Kind::undecodable, "pictures that cannot be decoded"},
                                   {Kind::incomplete, "pictures that are incomplete or of another size"},
                                   {Kind::missed, "pictures that its driver lost"}}) {
    StreamRemarks remarks;
    remarks.setTotal(kind, 99);
    EXPECT_EQ(remarks.text(), "") << text;
    remarks.add(kind);
    EXPECT_EQ(remarks.count(kind), 100U);
    EXPECT_THAT(remarks.text(), HasSubstr(std::string(text) + " (100 or more)"));
  }
}

}  // namespace
}  // namespace cartvo::capture
