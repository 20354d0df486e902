// Kannala and Brandt's distortion, compared with OpenCV's fisheye module.
#include "calib/model/wide_distortion.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calib/model/arc_tangent.hpp"
#include "calib/model/lens.hpp"
#include "calib/rectification/rectification.hpp"
#include "calib/rectification/rectification_tables.hpp"
#include "support/calib/rigs.hpp"

namespace cartvo::calib {
namespace {

TEST(PortableArcTangent, AgreesWithTheLibrary) {
  for (const double x : {1e-9, 0.01, 0.3, 1.0, 2.5, 40.0, 1e6})
    EXPECT_NEAR(portableArcTangent(x) / std::atan(x), 1.0, 4e-15) << x;
  EXPECT_EQ(portableArcTangent(0.0), 0.0);
}

TEST(PortableTangent, AgreesWithTheLibrary) {
  for (const double angle : {1e-9, 0.01, 0.3, 1.0, 1.3, 1.5})
    EXPECT_NEAR(portableTangent(angle) / std::tan(angle), 1.0, 1e-13) << angle;
  EXPECT_EQ(portableTangent(0.0), 0.0);
}

TEST(WideDistortion, DistortsLikeOpenCvFisheye) {
  const CameraModel camera = test::wideRig().left;
  const WideDistortion lens(camera);
  const cv::Vec4d coefficients(camera.distortion[0], camera.distortion[1], camera.distortion[2],
                               camera.distortion[3]);
  for (const cv::Point2d ideal : {cv::Point2d(0.0, 0.0), {0.5, 0.3}, {-2.6, 0.1}, {0.2, -4.0}}) {
    std::vector<cv::Point2d> expected;
    cv::fisheye::distortPoints(std::vector<cv::Point2d>{ideal}, expected, cv::Matx33d::eye(), coefficients);
    const NormalisedPoint distorted = lens.distort({3.0 * ideal.x, 3.0 * ideal.y, 3.0});
    EXPECT_NEAR(distorted.x, expected[0].x, 1e-12);
    EXPECT_NEAR(distorted.y, expected[0].y, 1e-12);
  }
}

TEST(WideDistortion, UndistortInvertsDistortEvenBehindTheCamera) {
  const WideDistortion lens(test::wideRig().left);
  for (const double angle : {0.0, 1e-6, 0.3, 1.0, 1.55, 1.62, 1.8}) {
    for (const double direction : {0.0, 1.0, 2.5, 4.0}) {
      const Eigen::Vector3d ray(std::sin(angle) * std::cos(direction), std::sin(angle) * std::sin(direction),
                                std::cos(angle));
      EXPECT_LT((lens.undistort(lens.distort(7.0 * ray)) - ray).norm(), 1e-13) << angle;
    }
  }
}

TEST(WideDistortion, EndsWhereTheModelFolds) {
  CameraModel camera;
  camera.lens = LensModel::wide;
  camera.distortion = {-0.3};
  const WideDistortion lens(camera);
  // a (1 - 0.3 a^2) turns back at a = 1 / sqrt(0.9).
  EXPECT_NEAR(lens.maxAngle(), 1.0 / std::sqrt(0.9), 2e-3);
  const NormalisedPoint rim = lens.distort({1.0, 0.0, -1.0});
  EXPECT_NEAR(rim.x, lens.maxAngle() * (1.0 - 0.3 * std::pow(lens.maxAngle(), 2.0)), 1e-12);
  EXPECT_NEAR(std::acos(lens.undistort({2.0, 0.0}).z()), lens.maxAngle(), 1e-9);
}

TEST(Lens, RectifiesAWideRigToCommonRowsWithTheDisparityOfTheDepth) {
  const Rig rig = test::wideRig();
  const Rectification rectification = computeRectification(rig, {});
  const RectificationTables tables = buildTables(rig, {});
  const auto source = [&](const PixelSources& sources, int column, int row) {
    const auto i = static_cast<std::size_t>(row) * tables.size.width + column;
    return Eigen::Vector2d(sources.column[i] + sources.column_fraction[i] / 256.0,
                           sources.row[i] + sources.row_fraction[i] / 256.0);
  };
  const auto seen = [](const CameraModel& camera, const Eigen::Vector3d& point) {
    const NormalisedPoint distorted = Lens(camera).distort(point);
    return Eigen::Vector2d(camera.fx * distorted.x + camera.cx, camera.fy * distorted.y + camera.cy);
  };
  constexpr int kDisparity = 8;
  for (const int row : {0, 100, 310, 419}) {
    for (const int column : {kDisparity, 200, 500, 679}) {
      const double depth = rectification.focal_length * rectification.baseline / kDisparity;
      const Eigen::Vector3d rectified((column - rectification.cx) / rectification.focal_length,
                                      (row - rectification.cy) / rectification.focal_length, 1.0);
      const Eigen::Vector3d in_left = rectification.R_rectified_left.transpose() * (depth * rectified);
      // Half of 1/256 px.
      EXPECT_LT((source(tables.left, column, row) - seen(rig.left, in_left)).cwiseAbs().maxCoeff(), 2.01e-3);
      EXPECT_LT((source(tables.right, column - kDisparity, row) - seen(rig.right, rig.T_right_left * in_left))
                    .cwiseAbs()
                    .maxCoeff(),
                2.01e-3);
    }
  }
}

TEST(Rectification, KeepsMoreOfAWideRigWithScalingUpTo70Degrees) {
  const Rig rig = test::wideRig();
  const Rectification cropped = computeRectification(rig, {.free_scaling = 0.0});
  const Rectification whole = computeRectification(rig, {.free_scaling = 1.0});
  EXPECT_LT(whole.focal_length, cropped.focal_length);
  const double half_height = 0.5 * whole.size.height / whole.focal_length;
  const double half_width = 0.5 * whole.size.width / whole.focal_length;
  EXPECT_LE(std::min(half_height, half_width), std::tan(70.0 * M_PI / 180.0));
}

TEST(RectificationTables, FingerprintDependsOnTheLensModel) {
  Rig brown = test::wideRig();
  brown.left.lens = brown.right.lens = LensModel::brown;
  EXPECT_NE(tablesFingerprint(brown, {}), tablesFingerprint(test::wideRig(), {}));
}

}  // namespace
}  // namespace cartvo::calib
