// Tests of the shift between images as a whole.
#include "vo_core/image/image_shift.hpp"

#include <gtest/gtest.h>

#include "support/vo_core/synthetic_texture.hpp"

namespace cartvo::vo {
namespace {

ImagePyramid textureAt(std::uint64_t seed, const Eigen::Vector2d& shift, double gain = 1.0) {
  const test::MultiscaleTexture texture(seed);
  return buildPyramid(
      test::draw(680, 420, [&](double x, double y) { return gain * texture(x - shift.x(), y - shift.y()); }),
      4);
}

TEST(ImageShift, IsFoundWithinTwoPixelsWhateverTheBrightness) {
  const ImagePyramid before = textureAt(5, {0.0, 0.0});
  for (const Eigen::Vector2d& shift :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(61.0, -23.0), Eigen::Vector2d(-90.0, 55.0)}) {
    const auto found = findImageShift(before, textureAt(5, shift, 0.6));
    ASSERT_TRUE(found) << shift.transpose();
    EXPECT_LT((*found - shift).norm(), 2.0) << shift.transpose();
  }
}

TEST(ImageShift, IsNotFoundBetweenAnImageAndABlankOne) {
  const ImagePyramid blank = buildPyramid(cv::Mat(420, 680, CV_8UC1, cv::Scalar(90)), 4);
  EXPECT_FALSE(findImageShift(textureAt(5, {0.0, 0.0}), blank));
}

TEST(ImageShift, IsFoundWithoutSmallLevels) {
  const auto at = [](double x) {
    static const test::MultiscaleTexture texture(5);
    return buildPyramid(test::draw(680, 420, [x](double u, double v) { return texture(u - x, v); }), 1);
  };
  const auto found = findImageShift(at(0.0), at(61.0));
  ASSERT_TRUE(found);
  EXPECT_LT((*found - Eigen::Vector2d(61.0, 0.0)).norm(), 2.0) << found->transpose();
}

}  // namespace
}  // namespace cartvo::vo
