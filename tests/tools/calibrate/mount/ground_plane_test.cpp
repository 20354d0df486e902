// Ground plane estimation on synthetic images of a plane.
#include "tools/calibrate/mount/ground_plane.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include <gtest/gtest.h>

namespace cartvo::calibrate {
namespace {

calib::Rectification cameras() {
  calib::Rectification rectification;
  rectification.size = {640, 400};
  rectification.focal_length = 480.0;
  rectification.cx = 319.5;
  rectification.cy = 180.0;
  rectification.baseline = 0.12;
  return rectification;
}

/// Non-repeating waves on the plane, with wavelengths from 5 cm.
double brightness(double x, double z) {
  return 128.0 + 25.0 * std::sin(31.0 * x + 11.0 * z) + 25.0 * std::sin(-47.3 * x + 59.7 * z) +
         20.0 * std::sin(97.1 * x - 23.9 * z) + 20.0 * std::sin(9.7 * x + 121.3 * z);
}

/// Image of the plane down . X = height from a camera at (x, 0, 0); grey beyond 15 m.
cv::Mat view(const calib::Rectification& rectification, double x, const Eigen::Vector3d& down,
             double height) {
  constexpr double kMaxDepth = 15.0;  // m
  cv::Mat image(rectification.size, CV_8UC1, cv::Scalar(128));
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const Eigen::Vector3d ray((column - rectification.cx) / rectification.focal_length,
                                (row - rectification.cy) / rectification.focal_length, 1.0);
      const double depth = (height - x * down.x()) / ray.dot(down);
      if (!(depth > 0.0 && depth < kMaxDepth)) continue;
      image.at<std::uint8_t>(row, column) =
          static_cast<std::uint8_t>(std::lround(brightness(x + depth * ray.x(), depth)));
    }
  }
  return image;
}

TEST(GroundPlane, IsEstimatedWithHeightAndNormal) {
  const calib::Rectification rectification = cameras();
  const Eigen::Vector3d down =
      Eigen::Vector3d(0.03, 1.0, 0.14).normalized();  // pitched down, slightly rolled
  const double height = 1.8;
  const auto ground = findGround(view(rectification, 0.0, down, height),
                                 view(rectification, rectification.baseline, down, height), rectification);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->height, height, 0.002);
  EXPECT_LT((ground->down - down).norm(), 0.0003);
  EXPECT_GT(ground->points, 2000);
}

TEST(GroundPlane, RejectsAWall) {
  const calib::Rectification rectification = cameras();
  cv::Mat left(rectification.size, CV_8UC1), right(rectification.size, CV_8UC1);
  constexpr double kDepth = 4.0;
  const double shift = rectification.focal_length * rectification.baseline / kDepth;
  for (int row = 0; row < left.rows; ++row) {
    for (int column = 0; column < left.cols; ++column) {
      const auto wave = [&](double x) { return static_cast<std::uint8_t>(brightness(x / 90.0, row / 90.0)); };
      left.at<std::uint8_t>(row, column) = wave(column);
      right.at<std::uint8_t>(row, column) = wave(column + shift);
    }
  }
  EXPECT_FALSE(findGround(left, right, rectification));
}

TEST(GroundPlane, RejectsAnEmptyImage) {
  const cv::Mat grey(cameras().size, CV_8UC1, cv::Scalar(90));
  EXPECT_FALSE(findGround(grey, grey, cameras()));
}

}  // namespace
}  // namespace cartvo::calibrate
