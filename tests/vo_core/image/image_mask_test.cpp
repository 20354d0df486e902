// Tests of the growth of masked regions by the patches of landmarks.
#include "vo_core/image/image_mask.hpp"

#include <gtest/gtest.h>

namespace cartvo::vo {
namespace {

TEST(ImageMask, AllowsAllPixelsWithoutAMask) {
  const ImageMask mask{cv::Mat()};
  EXPECT_TRUE(mask.empty());
  EXPECT_TRUE(mask.allows({-3.0, 1e4}, 1));
}

TEST(ImageMask, KeepsPatchesOfEachLevelFreeOfMaskedPixels) {
  cv::Mat used(120, 160, CV_8UC1, cv::Scalar(1));
  used(cv::Rect(60, 40, 10, 10)).setTo(0);  // columns 60 to 69
  const ImageMask mask(used);
  EXPECT_FALSE(mask.allows({65.0, 45.0}, 0));
  // A patch reaches 7 px of its level to all sides.
  EXPECT_FALSE(mask.allows({53.0, 45.0}, 0));
  EXPECT_TRUE(mask.allows({52.0, 45.0}, 0));
  EXPECT_FALSE(mask.allows({76.4, 45.0}, 0));
  EXPECT_TRUE(mask.allows({77.0, 45.0}, 0));
  EXPECT_FALSE(mask.allows({46.0, 45.0}, 1));
  EXPECT_TRUE(mask.allows({44.0, 45.0}, 1));
}

TEST(ImageMask, TakesPixelsOutsideTheImageForThoseOfItsBorder) {
  cv::Mat used(64, 64, CV_8UC1, cv::Scalar(255));
  used.row(0).setTo(0);
  const ImageMask mask(used);
  EXPECT_FALSE(mask.allows({-5.0, -5.0}, 0));
  EXPECT_TRUE(mask.allows({70.0, 70.0}, 0));
}

}  // namespace
}  // namespace cartvo::vo
