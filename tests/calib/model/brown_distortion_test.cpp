// Brown's distortion, compared with OpenCV's projection.
#include "calib/model/brown_distortion.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "support/calib/rigs.hpp"

namespace cartvo::calib {
namespace {

TEST(BrownDistortion, DistortsLikeOpenCv) {
  const Rig rig = test::cartRig();
  CameraModel camera = rig.left;
  camera.distortion = {-0.2, 0.05, 0.001, -0.002, 0.01, 0.02, 0.01, -0.003};
  const BrownDistortion lens(camera);
  for (const NormalisedPoint ideal : {NormalisedPoint{0.0, 0.0}, {0.5, 0.3}, {-0.6, 0.1}, {0.2, -0.4}}) {
    std::vector<cv::Point2d> expected;
    cv::projectPoints(std::vector<cv::Point3d>{{ideal.x, ideal.y, 1.0}}, cv::Vec3d(), cv::Vec3d(),
                      cv::Matx33d::eye(), camera.distortion, expected);
    const NormalisedPoint distorted = lens.distort(ideal);
    EXPECT_NEAR(distorted.x, expected[0].x, 1e-12);
    EXPECT_NEAR(distorted.y, expected[0].y, 1e-12);
  }
}

TEST(BrownDistortion, UndistortInvertsDistort) {
  const BrownDistortion lens(test::cartRig().left);
  for (int row = -3; row <= 3; ++row) {
    for (int column = -5; column <= 5; ++column) {
      const double x = 0.15 * column, y = 0.15 * row;
      const NormalisedPoint back = lens.undistort(lens.distort({x, y}));
      EXPECT_NEAR(back.x, x, 1e-11);
      EXPECT_NEAR(back.y, y, 1e-11);
    }
  }
}

TEST(BrownDistortion, EndsWhereTheModelFolds) {
  CameraModel camera;
  camera.distortion = {-0.3};
  const BrownDistortion lens(camera);
  // r (1 - 0.3 r^2) turns back at r = 1 / sqrt(0.9).
  EXPECT_NEAR(lens.maxRadius(), 1.0 / std::sqrt(0.9), 2e-3);
  EXPECT_NEAR(lens.distort({5.0, 0.0}).x, lens.distort({lens.maxRadius(), 0.0}).x, 1e-12);
  EXPECT_THROW(lens.undistort({0.8, 0.0}), std::invalid_argument);
}

}  // namespace
}  // namespace cartvo::calib
