// Compares pyramids with those of OpenCV and tests the reuse of their memory.
#include "vo_core/image/image_pyramid.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/image/image_mask.hpp"

namespace cartvo::vo {
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

/// Compares a level and its border with cv::copyMakeBorder.
void expectEqual(const PyramidLevel& level, const cv::Mat& expected) {
  constexpr int kBorder = PyramidLevel::kBorder;
  ASSERT_EQ(level.width(), expected.cols);
  ASSERT_EQ(level.height(), expected.rows);
  cv::Mat padded;
  cv::copyMakeBorder(expected, padded, kBorder, kBorder, kBorder, kBorder, cv::BORDER_REFLECT_101);
  for (int y = 0; y < padded.rows; ++y)
    for (int x = 0; x < padded.cols; ++x)
      ASSERT_EQ(*level.at(x - kBorder, y - kBorder), padded.at<std::uint8_t>(y, x)) << x << ", " << y;
}

cv::Mat differenceOfGaussians(const cv::Mat& grey) {
  cv::Mat blurred, difference;
  cv::GaussianBlur(grey, blurred, cv::Size(5, 5), 1.0);
  cv::addWeighted(grey, 3.0, blurred, -3.0, 128.0, difference);
  return difference;
}

TEST(ImagePyramid, EqualsOpenCV) {
  test::Noise noise(6);
  for (const cv::Size& size :
       {cv::Size(1, 1), cv::Size(7, 30), cv::Size(8, 8), cv::Size(9, 25), cv::Size(26, 11), cv::Size(63, 40),
        cv::Size(130, 65), cv::Size(257, 98), cv::Size(340, 211)}) {
    SCOPED_TRACE(testing::Message() << size);
    // Black, white and grey noise; a part of a larger image whose other pixels must not be read.
    const cv::Mat parent = test::draw(size.width + 9, size.height + 5, [&](int x, int) {
      return x % 2 == 0 ? 255.0 * noise.uniform() : noise.uniform() < 0.5 ? 0.0 : 255.0;
    });
    cv::Mat level = parent(cv::Rect(cv::Point(5, 3), size)).clone();
    const ImagePyramid pyramid = buildPyramid(parent(cv::Rect(cv::Point(5, 3), size)), 3);
    for (std::size_t index = 0; index < 4; ++index) {
      if (index > 0) {
        if (std::min(level.cols, level.rows) < 8) {
          EXPECT_EQ(pyramid.grey.size(), std::min<std::size_t>(index, 3));
          EXPECT_EQ(pyramid.dog.size(), index - 1);
          break;
        }
        cv::Mat half;
        cv::pyrDown(level, half);
        level = half;
      }
      if (index < 3) expectEqual(pyramid.grey[index], level);
      if (index > 0) expectEqual(pyramid.dog[index - 1], differenceOfGaussians(level));
    }
  }
}

TEST(ImagePyramid, PoolBuildsTheSamePyramids) {
  PyramidPool pool(4);
  for (const unsigned seed : {1U, 2U, 3U}) {
    const SharedPyramid shared = pool.build(image(seed));
    const ImagePyramid& pooled = *shared;
    const ImagePyramid fresh = buildPyramid(image(seed), 4);
    ASSERT_EQ(pooled.grey.size(), 4U);
    ASSERT_EQ(pooled.dog.size(), fresh.dog.size());
    for (std::size_t i = 0; i < fresh.grey.size(); ++i)
      expectEqual(pooled.grey[i], fresh.grey[i]);
    for (std::size_t i = 0; i < fresh.dog.size(); ++i)
      expectEqual(pooled.dog[i], fresh.dog[i]);
  }
}

TEST(ImagePyramid, PoolOverwritesOnlyReleasedPyramids) {
  PyramidPool pool(2);
  const SharedPyramid kept = pool.build(image(1));
  const std::uint8_t* const second = pool.build(image(2))->grey[0].at(0, 0);
  EXPECT_NE(second, kept->grey[0].at(0, 0));
  EXPECT_EQ(pool.build(image(3))->grey[0].at(0, 0), second);
  expectEqual(kept->grey[1], buildPyramid(image(1), 2).grey[1]);
}

TEST(ImagePyramid, PoolDoesNotCopyImagesInALease) {
  PyramidPool pool(3);
  const SharedPyramid kept = pool.build(image(1));
  PyramidLease lease = pool.lease({kWidth, kHeight});
  const cv::Mat buffer = lease.image();
  image(2).copyTo(buffer);
  EXPECT_TRUE(lease.holds(buffer));
  EXPECT_FALSE(lease.holds(image(2)));
  const SharedPyramid built = pool.build(std::move(lease));
  EXPECT_EQ(built->grey[0].at(0, 0), buffer.data);
  const ImagePyramid fresh = buildPyramid(image(2), 3);
  for (std::size_t i = 0; i < fresh.grey.size(); ++i)
    expectEqual(built->grey[i], fresh.grey[i]);
  expectEqual(kept->grey[0], buildPyramid(image(1), 3).grey[0]);
  EXPECT_NE(pool.lease({kWidth, kHeight}).image().data, buffer.data);  // `built` still owns it
}

TEST(ImagePyramid, PoolKeepsALeaseForItsHolder) {
  PyramidPool pool(2);
  const PyramidLease lease = pool.lease({kWidth, kHeight});
  const cv::Mat buffer = lease.image();
  image(2).copyTo(buffer);
  EXPECT_NE(pool.build(image(1))->grey[0].at(0, 0), buffer.data);
  EXPECT_NE(pool.lease({kWidth, kHeight}).image().data, buffer.data);
  EXPECT_EQ(cv::norm(buffer, image(2), cv::NORM_INF), 0.0);
  EXPECT_TRUE(PyramidLease().image().empty());
}

TEST(ImagePyramid, BorderMirrorsTheImage) {
  const ImagePyramid pyramid = buildPyramid(image(1), 1);
  const PyramidLevel& level = pyramid.grey.front();
  EXPECT_EQ(*level.at(-5, 10), *level.at(5, 10));
  EXPECT_EQ(*level.at(kWidth - 1 + 7, kHeight - 1 + 3), *level.at(kWidth - 1 - 7, kHeight - 1 - 3));
}

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
