// Pyramids keep their pixels for as long as somebody has them, and no memory beyond that.
#include "vo_core/image_pyramid.hpp"

#include <gtest/gtest.h>

#include "vo_core/synthetic_texture.hpp"

namespace cartvo {
namespace {

constexpr int kWidth = 83, kHeight = 61;

cv::Mat image(unsigned seed) {
  return test::draw(kWidth, kHeight, test::WaveTexture(seed));
}

void expectEqual(const PyramidLevel& a, const PyramidLevel& b) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  for (int y = -PyramidLevel::kBorder; y < a.height() + PyramidLevel::kBorder; ++y)
    for (int x = -PyramidLevel::kBorder; x < a.width() + PyramidLevel::kBorder; ++x)
      ASSERT_EQ(*a.at(x, y), *b.at(x, y)) << x << ", " << y;
}

TEST(ImagePyramid, APoolsPyramidsAreAsFreshOnes) {
  PyramidPool pool(4);
  for (const unsigned seed : {1U, 2U, 3U}) {
    const ImagePyramid pooled = pool.build(image(seed));
    const ImagePyramid fresh = buildPyramid(image(seed), 4);
    ASSERT_EQ(pooled.grey.size(), 4U);
    ASSERT_EQ(pooled.dog.size(), fresh.dog.size());
    for (std::size_t i = 0; i < fresh.grey.size(); ++i)
      expectEqual(pooled.grey[i], fresh.grey[i]);
    for (std::size_t i = 0; i < fresh.dog.size(); ++i)
      expectEqual(pooled.dog[i], fresh.dog[i]);
  }
}

TEST(ImagePyramid, APoolOverwritesOnlyWhatNobodyHas) {
  PyramidPool pool(2);
  const ImagePyramid kept = pool.build(image(1));
  const std::uint8_t* const second = pool.build(image(2)).grey[0].at(0, 0);
  EXPECT_NE(second, kept.grey[0].at(0, 0));
  EXPECT_EQ(pool.build(image(3)).grey[0].at(0, 0), second);
  expectEqual(kept.grey[1], buildPyramid(image(1), 2).grey[1]);
}

TEST(ImagePyramid, TheBorderMirrorsTheImage) {
  const ImagePyramid pyramid = buildPyramid(image(1), 1);
  const PyramidLevel& level = pyramid.grey.front();
  EXPECT_EQ(*level.at(-5, 10), *level.at(5, 10));
  EXPECT_EQ(*level.at(kWidth - 1 + 7, kHeight - 1 + 3), *level.at(kWidth - 1 - 7, kHeight - 1 - 3));
}

}  // namespace
}  // namespace cartvo
