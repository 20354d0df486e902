// Tests of the search for patches, on images shifted by a known amount.
#include "vo_core/image/patch_search.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/vo_core/corridor_world.hpp"

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

}  // namespace
}  // namespace cartvo::vo
