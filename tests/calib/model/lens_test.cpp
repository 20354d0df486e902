// Distortion of lenses by Brown's and the wide model, and projection through them.
#include "calib/model/lens.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calib/model/projection.hpp"
#include "calib/rectification/rectification.hpp"
#include "calib/rectification/rectification_tables.hpp"
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

class Projection : public ::testing::TestWithParam<LensModel> {
 protected:
  static CameraModel camera() {
    if (GetParam() == LensModel::wide) return test::wideRig().left;
    CameraModel brown = test::cartRig().left;
    brown.distortion = {-0.2, 0.05, 0.001, -0.002, 0.01, 0.02, 0.01, -0.003};
    return brown;
  }
};

TEST_P(Projection, AgreesWithLens) {
  const Eigen::Vector3d point(0.4, -0.3, 1.2);
  const NormalisedPoint distorted = Lens(camera()).distort(point);
  const Eigen::Vector2d pixel = project(camera(), point)->pixel;
  EXPECT_NEAR(pixel.x(), camera().fx * distorted.x + camera().cx, 1e-9);
  EXPECT_NEAR(pixel.y(), camera().fy * distorted.y + camera().cy, 1e-9);
}

TEST_P(Projection, DerivativesAgreeWithFiniteDifferences) {
  constexpr double kStep = 1e-6;
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.4, -0.3, 1.2), {-0.7, 0.1, 0.8}, {1e-12, 0.0, 2.0}}) {
    const LensProjection projection = *project(camera(), point);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const Eigen::Vector2d difference =
          (project(camera(), point + step)->pixel - project(camera(), point - step)->pixel) / (2.0 * kStep);
      EXPECT_LT((projection.J_point.col(k) - difference).norm(), 1e-4) << point.transpose() << " by " << k;
    }
    const int parameters = GetParam() == LensModel::wide ? 8 : kCameraParameters;
    for (int k = 0; k < parameters; ++k) {
      CameraModel more = camera(), less = camera();
      const CameraParameters step = kStep * CameraParameters::Unit(k);
      setParameters(parametersOf(camera()) + step, more);
      setParameters(parametersOf(camera()) - step, less);
      const Eigen::Vector2d difference =
          (project(more, point)->pixel - project(less, point)->pixel) / (2.0 * kStep);
      EXPECT_LT((projection.J_camera.col(k) - difference).norm(), 1e-4) << point.transpose() << " by " << k;
    }
  }
}

TEST_P(Projection, IsUndefinedBehindTheCamera) {
  EXPECT_FALSE(project(camera(), {0.0, 0.0, -1.0}));
}

INSTANTIATE_TEST_SUITE_P(, Projection, ::testing::Values(LensModel::brown, LensModel::wide),
                         [](const auto& lens) { return lens.param == LensModel::wide ? "Wide" : "Brown"; });

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
