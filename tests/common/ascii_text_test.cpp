// Letters and blanks of ASCII text.

#include "common/ascii_text.hpp"

#include <gtest/gtest.h>

namespace cartvo {
namespace {

TEST(AsciiText, ChangesLettersOfAsciiOnly) {
  EXPECT_EQ(lowerCase("RTSP://Ä[1]z"), "rtsp://Ä[1]z");
  EXPECT_EQ(upperCase("sha-256{é"), "SHA-256{é");
}

TEST(AsciiText, TrimsBothEnds) {
  EXPECT_EQ(trimmed(" \t a b \r\n"), "a b");
  EXPECT_EQ(trimmed(" \r\n"), "");
  EXPECT_EQ(trimmed(""), "");
}

}  // namespace
}  // namespace cartvo
