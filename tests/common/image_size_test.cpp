// Parsing and formatting of image sizes, such as "680x420".
#include "common/image_size.hpp"

#include <gtest/gtest.h>

namespace cartvo {
namespace {

TEST(ImageSize, IsReadAsItIsWritten) {
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(680, 420), cv::Size(99999, 7)})
    EXPECT_EQ(parseImageSize(sizeText(size)), size);
  EXPECT_EQ(sizeText({1241, 376}), "1241x376");
}

TEST(ImageSize, RefusesOtherText) {
  for (const char* text : {"",
                           "x",
                           "680",
                           "680x",
                           "x420",
                           "680x420x",
                           "680x420 ",
                           " 680x420",
                           "680X420",
                           "680 x420",
                           "-680x420",
                           "680x-420",
                           "+680x420",
                           "680x+420",
                           "0x420",
                           "680x0",
                           "0680x420",
                           "100000x420",
                           "680x99999999999",
                           "99999999999x420",
                           "680.5x420"})
    EXPECT_FALSE(parseImageSize(text)) << text;
}

}  // namespace
}  // namespace cartvo
