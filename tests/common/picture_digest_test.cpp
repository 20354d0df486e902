// Tests of the digest of a picture.
#include "common/picture_digest.hpp"

#include <gtest/gtest.h>

namespace cartvo {
namespace {

cv::Mat texture() {
  cv::Mat image(16, 41, CV_8UC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(37 * x + 11 * y);
  return image;
}

TEST(PictureDigest, DistinguishesPictures) {
  cv::Mat image = texture();
  const std::uint64_t digest = pictureDigest(image);
  EXPECT_EQ(pictureDigest(image.clone()), digest);
  for (const int column : {0, 7, 17, 40}) {  // the last one is beyond the last eight bytes
    ++image.at<std::uint8_t>(8, column);
    EXPECT_NE(pictureDigest(image), digest) << column;
    --image.at<std::uint8_t>(8, column);
  }
}

TEST(PictureDigest, LeavesOutMaskedPixels) {
  cv::Mat image = texture();
  cv::Mat mask(image.size(), CV_8UC1, cv::Scalar(1));
  EXPECT_EQ(pictureDigest(image, mask), pictureDigest(image));
  for (const int column : {0, 7, 17, 40}) {
    mask.at<std::uint8_t>(8, column) = 0;
    const std::uint64_t digest = pictureDigest(image, mask);
    ++image.at<std::uint8_t>(8, column);
    EXPECT_EQ(pictureDigest(image, mask), digest) << column;
    if (column < 40) {
      ++image.at<std::uint8_t>(8, column + 1);
      EXPECT_NE(pictureDigest(image, mask), digest) << column;
    }
  }
}

TEST(PictureDigest, TellsUniformPictures) {
  EXPECT_FALSE(isUniform(texture()));
  cv::Mat image(16, 41, CV_8UC1, cv::Scalar(16));
  EXPECT_TRUE(isUniform(image));
  image.at<std::uint8_t>(8, 10) = 235;  // as of a line of text
  EXPECT_TRUE(isUniform(image));
}

}  // namespace
}  // namespace cartvo
