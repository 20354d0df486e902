// Rectification of whole images.
#include "calib/rectification/rectifier.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "calib/model/lens.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"

namespace cartvo::calib {
namespace {

using ::testing::HasSubstr;

Rectifier rectifierFor(const Rig& rig) {
  return Rectifier(rig, {}, buildTables(rig, {}));
}

/// A smooth pattern at infinity: the grey value of a direction.
double grey(const Eigen::Vector3d& ray) {
  return 128.0 + 60.0 * std::sin(40.0 * ray.x() / ray.z()) + 50.0 * std::cos(35.0 * ray.y() / ray.z());
}

/// The image of the pattern in a camera. `R_sky_camera` takes the camera's axes to the pattern's.
cv::Mat rawImage(const CameraModel& camera, const Eigen::Matrix3d& R_sky_camera) {
  const BrownDistortion lens(camera);
  cv::Mat image(camera.size, CV_8UC1);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const NormalisedPoint ideal =
          lens.undistort({(column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy});
      const double value = grey(R_sky_camera * Eigen::Vector3d(ideal.x, ideal.y, 1.0));
      image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(std::lround(value));
    }
  }
  return image;
}

TEST(Rectifier, MakesADistantSceneEqualInBothImages) {
  const Rig rig = test::cartRig();
  const Rectifier rectifier = rectifierFor(rig);
  const Rectification& rectification = rectifier.rectification();
  cv::Mat left, right;
  rectifier.rectifyLeft(rawImage(rig.left, rectification.R_rectified_left), left);
  rectifier.rectifyRight(rawImage(rig.right, rectification.R_rectified_right), right);
  double largest = 0.0;
  for (int row = 1; row + 1 < left.rows; ++row) {
    for (int column = 1; column + 1 < left.cols; ++column) {
      const double expected = grey({(column - rectification.cx) / rectification.focal_length,
                                    (row - rectification.cy) / rectification.focal_length, 1.0});
      largest = std::max({largest, std::abs(left.at<std::uint8_t>(row, column) - expected),
                          std::abs(right.at<std::uint8_t>(row, column) - expected)});
    }
  }
  // Rounding of the raw image and of the result, half a grey value each, and the curvature of the pattern
  // between pixels.
  EXPECT_LT(largest, 1.6);
}

TEST(Rectifier, RectifiesTheMasksLikeTheImages) {
  Rig rig = test::cartRig();
  rig.left.mask = maskOfPolygons({{{100, 300}, {250, 310}, {240, 400}}}, rig.left.size);
  const Rectifier rectifier = rectifierFor(rig);
  EXPECT_TRUE(rectifier.rightMask().empty());
  cv::Mat image;
  rectifier.rectifyLeft(rig.left.mask.used, image);
  ASSERT_EQ(rectifier.leftMask().size(), image.size());
  // A pixel is masked as soon as a part of it is: it is then darker than white.
  int masked = 0, differing = 0;
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const bool is_masked = rectifier.leftMask().at<std::uint8_t>(row, column) == 0;
      const std::uint8_t value = image.at<std::uint8_t>(row, column);
      EXPECT_TRUE(is_masked || value == 255) << column << ", " << row;
      masked += is_masked ? 1 : 0;
      differing += is_masked && value == 255 ? 1 : 0;
    }
  }
  EXPECT_GT(masked, 5000);
  EXPECT_LT(differing, masked / 20);  // interpolated with a weight of nearly 0
}

TEST(Rectifier, RefusesAMaskOfAnotherSize) {
  Rig rig = test::cartRig();
  rig.left.mask = maskOfPolygons({{{0, 0}, {9, 0}, {9, 9}}}, {320, 240});
  EXPECT_THROW(rectifierFor(rig), std::invalid_argument);
  rig.left.mask = maskOfPart(maskOfPolygons({{{0, 0}, {9, 0}, {9, 9}}}, {700, 500}), {{0, 0}, rig.left.size});
  EXPECT_EQ(rectifierFor(rig).leftMask().size(), rig.left.size);
}

TEST(Rectifier, TakesTheMasksOfRectifiedImagesAsTheyAre) {
  Rig rig = test::rectifiedRig();
  rig.right.mask = maskOfPolygons({{{0, 0}, {90, 0}, {90, 90}}}, rig.right.size);
  EXPECT_EQ(cv::norm(rectifierFor(rig).rightMask(), rig.right.mask.used, cv::NORM_INF), 0.0);
}

TEST(Rectifier, PassesRectifiedImagesThroughWithoutACopy) {
  const Rectifier rectifier = rectifierFor(test::rectifiedRig());
  const cv::Mat raw(480, 640, CV_8UC1, cv::Scalar(7));
  cv::Mat left, right;
  rectifier.rectifyLeft(raw, left);
  rectifier.rectifyRight(raw, right);
  EXPECT_EQ(left.data, raw.data);
  EXPECT_EQ(right.data, raw.data);
}

TEST(Rectifier, ReusesTheMemoryOfTheOutputButNotOfTheInput) {
  const Rectifier rectifier = rectifierFor(test::cartRig());
  const cv::Mat raw(420, 680, CV_8UC1, cv::Scalar(7));
  cv::Mat rectified;
  rectifier.rectifyLeft(raw, rectified);
  const auto* memory = rectified.data;
  rectifier.rectifyLeft(raw, rectified);
  EXPECT_EQ(rectified.data, memory);
  cv::Mat shared = raw;
  rectifier.rectifyLeft(raw, shared);
  EXPECT_NE(shared.data, raw.data);
}

TEST(Rectifier, RefusesImagesOfAnotherSizeStatingBoth) {
  const Rectifier rectifier = rectifierFor(test::cartRig());
  const cv::Mat raw(720, 1280, CV_8UC1);
  cv::Mat rectified;
  EXPECT_EQ(
      test::messageOf([&] { rectifier.rectifyRight(raw, rectified); }),
      "the right camera's images are 1280x720 but rig 'cart' was calibrated at 680x420: set the camera to "
      "680x420, or calibrate it at 1280x720");
  const Rectifier identity = rectifierFor(test::rectifiedRig());
  EXPECT_THAT(test::messageOf([&] { identity.rectifyLeft(raw, rectified); }), HasSubstr("are 1280x720 but"));
}

TEST(Rectifier, RefusesColourImages) {
  const Rectifier rectifier = rectifierFor(test::cartRig());
  cv::Mat rectified;
  EXPECT_THAT(test::messageOf([&] { rectifier.rectifyLeft(cv::Mat(420, 680, CV_8UC3), rectified); }),
              HasSubstr("not grey"));
}

TEST(Rectifier, RefusesTablesOfAnotherRig) {
  Rig other = test::cartRig();
  other.left.fx += 1.0;
  EXPECT_THAT(test::messageOf([&] { Rectifier(test::cartRig(), {}, buildTables(other, {})); }),
              HasSubstr("not those of rig 'cart'"));
}

}  // namespace
}  // namespace cartvo::calib
