// Tests of the search for patches, on images shifted by a known amount.
#include "vo_core/image/patch_search.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"
#include "support/vo_core/synthetic_texture.hpp"
#include "vo_core/image/image_shift.hpp"
#include "vo_core/image/shift_tracking.hpp"

namespace cartvo::vo {
namespace {

const StereoCamera kCamera{300.0, 200.0, 110.0, 0.2, 400, 220};

cv::Mat texture(std::uint64_t seed = 1) {
  return test::CorridorWorld(seed).view(kCamera, Eigen::Isometry3d::Identity());
}

/// The image moved by whole pixels, with its border repeated.
cv::Mat moved(const cv::Mat& image, int x, int y) {
  cv::Mat result(image.size(), image.type());
  for (int row = 0; row < image.rows; ++row)
    for (int column = 0; column < image.cols; ++column)
      result.at<std::uint8_t>(row, column) = image.at<std::uint8_t>(
          std::clamp(row - y, 0, image.rows - 1), std::clamp(column - x, 0, image.cols - 1));
  return result;
}

TEST(PatchSearch, FindsDisplacementsOfBothSigns) {
  const cv::Mat image = texture();
  PatchSearch search(image.cols);
  const ImagePyramid from = buildPyramid(image, search.levels());
  for (const Eigen::Vector2i& shift : {Eigen::Vector2i(0, 0), {31, 0}, {-31, 0}, {-12, 9}, {12, -9}}) {
    const ImagePyramid to = buildPyramid(moved(image, shift.x(), shift.y()), search.levels());
    search.setSearched(to, 4);
    int found = 0;
    for (const Eigen::Vector2i& centre : search.choosePatches(from)) {
      const auto displacement = search.find(from, centre);
      if (displacement && (*displacement - shift.cast<double>()).norm() < 0.2) ++found;
    }
    EXPECT_GT(found, 30) << shift.transpose();
  }
}

TEST(PatchSearch, FindsNothingInAnUnrelatedImage) {
  const cv::Mat image = texture();
  PatchSearch search(image.cols);
  const ImagePyramid from = buildPyramid(image, search.levels());
  const ImagePyramid to = buildPyramid(cv::Mat(image.size(), CV_8UC1, cv::Scalar(90)), search.levels());
  search.setSearched(to, 4);
  for (const Eigen::Vector2i& centre : search.choosePatches(from))
    EXPECT_FALSE(search.find(from, centre));
}

TEST(PatchSearch, ChoosesNoPatchWithoutTexture) {
  const ImagePyramid uniform = buildPyramid(cv::Mat(220, 400, CV_8UC1, cv::Scalar(90)), 2);
  EXPECT_TRUE(PatchSearch(400).choosePatches(uniform).empty());
}

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

constexpr int kWidth = 320, kHeight = 240, kLevels = 4;
const Eigen::Vector2d kMove(6.4, -3.7);  // px
constexpr double kLeastCorrelation = 0.5;

struct TestImages {
  ImagePyramid before, after;

  TestImages() {
    const test::WaveTexture texture(5);
    before = buildPyramid(test::draw(kWidth, kHeight, texture), kLevels);
    after =
        buildPyramid(test::draw(kWidth, kHeight,
                                [&](double x, double y) { return texture(x - kMove.x(), y - kMove.y()); }),
                     kLevels);
  }
  ShiftTask task(const Eigen::Vector2d& from, const PyramidLevels& levels) const {
    return {&before, &after, from, from, levels};
  }
};

TEST(ShiftTracking, IsMoreAccurateTheFinerItsLastLevel) {
  const TestImages images;
  for (const int finest : {0, 1, 2}) {
    test::Statistics error;
    for (int x = 50; x < kWidth - 50; x += 9) {
      const Eigen::Vector2d from(x + 0.3, 118.6);
      const auto shifted = trackShift(images.task(from, {finest, kLevels - 1}), kLeastCorrelation);
      if (shifted) error.add((*shifted - from - kMove).norm());
    }
    EXPECT_GT(error.count(), 15) << finest;
    EXPECT_LT(error.mean(), 0.15 * (1 << finest)) << finest;
  }
}

TEST(ShiftTracking, GivesTheSameResultsTogetherAsAlone) {
  const TestImages images;
  const PyramidLevels several[] = {{0, 3}, {1, 1}, {2, 3}, {1, 3}, {0, 9}, {5, 6}};
  std::vector<ShiftTask> tasks;
  for (int i = 0; i < 27; ++i) {
    const Eigen::Vector2d from(3.3 + 12.7 * i, 20.6 + 7.0 * i);  // the last ones lie outside
    tasks.push_back(images.task(from, several[i % 6]));
    tasks.back().guess += Eigen::Vector2d(i % 4, 2.0 - i % 3);
  }
  int found = 0;
  for (const std::size_t count : {0UL, 1UL, 3UL, 4UL, 6UL, tasks.size()}) {
    std::vector<std::optional<Eigen::Vector2d>> together(count);
    trackShifts(std::span(tasks).first(count), kLeastCorrelation, together);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(together[i], trackShift(tasks[i], kLeastCorrelation)) << i << " of " << count;
      found += together[i] ? 1 : 0;
    }
  }
  EXPECT_GT(found, 20);
}

}  // namespace

}  // namespace cartvo::vo
