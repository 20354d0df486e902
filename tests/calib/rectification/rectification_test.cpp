// Rectification of a rig, compared with OpenCV and with projected points.
#include "calib/rectification/rectification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "calib/model/lens.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"

namespace cartvo::calib {
namespace {

using ::testing::HasSubstr;

Eigen::Vector2d project(const Rectification& rectification, const Eigen::Vector3d& point) {
  return {rectification.focal_length * point.x() / point.z() + rectification.cx,
          rectification.focal_length * point.y() / point.z() + rectification.cy};
}

TEST(Rectification, ProjectsAPointToTheSameRowWithTheDisparityOfItsDepth) {
  const Rig rig = test::cartRig();
  const Rectification rectification = computeRectification(rig, {});
  for (const Eigen::Vector3d& in_left :
       {Eigen::Vector3d(0.5, -0.4, 3.0), {-2.0, 1.0, 8.0}, {3.0, 0.2, 40.0}}) {
    const Eigen::Vector3d in_right = rig.T_right_left * in_left;
    const Eigen::Vector3d rectified_left = rectification.R_rectified_left * in_left;
    const Eigen::Vector2d left = project(rectification, rectified_left);
    const Eigen::Vector2d right = project(rectification, rectification.R_rectified_right * in_right);
    EXPECT_NEAR(left.y(), right.y(), 1e-9);
    const double disparity = rectification.focal_length * rectification.baseline / rectified_left.z();
    EXPECT_NEAR(left.x() - right.x(), disparity, 1e-9);
  }
}

TEST(Rectification, RotatesTheCamerasLikeOpenCv) {
  const Rig rig = test::cartRig();
  const Rectification rectification = computeRectification(rig, {});
  const auto intrinsics = [](const CameraModel& camera) {
    return cv::Matx33d(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  };
  cv::Matx33d R;
  cv::Vec3d T;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      R(i, j) = rig.T_right_left.linear()(i, j);
    T[i] = rig.T_right_left.translation()[i];
  }
  cv::Matx33d R_left, R_right;
  cv::Matx34d P_left, P_right;
  cv::Mat Q;
  cv::stereoRectify(intrinsics(rig.left), rig.left.distortion, intrinsics(rig.right), rig.right.distortion,
                    rig.left.size, R, T, R_left, R_right, P_left, P_right, Q, cv::CALIB_ZERO_DISPARITY, 0.0);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(rectification.R_rectified_left(i, j), R_left(i, j), 1e-9);
      EXPECT_NEAR(rectification.R_rectified_right(i, j), R_right(i, j), 1e-9);
    }
  }
  // OpenCV uses a grid of 9 x 9 points and keeps some margin; the whole outline gives about the same view.
  EXPECT_NEAR(rectification.focal_length, P_left(0, 0), 0.05 * P_left(0, 0));
}

TEST(Rectification, HasASourceForEachPixelAtScalingZeroAndKeepsEachRawPixelAtOne) {
  const Rig rig = test::cartRig();
  const Rectification cropped = computeRectification(rig, {.free_scaling = 0.0});
  const Rectification whole = computeRectification(rig, {.free_scaling = 1.0});
  const double right = rig.left.size.width - 1.0, bottom = rig.left.size.height - 1.0;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(0, 0), {right, 0}, {0, bottom}, {right, bottom}, {right / 2, 0}, {0, bottom / 2}}) {
    const Eigen::Vector3d ray((corner.x() - cropped.cx) / cropped.focal_length,
                              (corner.y() - cropped.cy) / cropped.focal_length, 1.0);
    for (const auto& [camera, R] :
         {std::pair(rig.left, cropped.R_rectified_left), std::pair(rig.right, cropped.R_rectified_right)}) {
      const Eigen::Vector3d direction = R.transpose() * ray;
      const NormalisedPoint raw =
          BrownDistortion(camera).distort({direction.x() / direction.z(), direction.y() / direction.z()});
      EXPECT_GE(camera.fx * raw.x + camera.cx, -1e-6);
      EXPECT_LE(camera.fx * raw.x + camera.cx, right + 1e-6);
      EXPECT_GE(camera.fy * raw.y + camera.cy, -1e-6);
      EXPECT_LE(camera.fy * raw.y + camera.cy, bottom + 1e-6);
    }
    const NormalisedPoint ideal = BrownDistortion(rig.left).undistort(
        {(corner.x() - rig.left.cx) / rig.left.fx, (corner.y() - rig.left.cy) / rig.left.fy});
    const Eigen::Vector2d seen =
        project(whole, whole.R_rectified_left * Eigen::Vector3d(ideal.x, ideal.y, 1.0));
    EXPECT_GE(seen.x(), -1e-6);
    EXPECT_LE(seen.x(), right + 1e-6);
    EXPECT_GE(seen.y(), -1e-6);
    EXPECT_LE(seen.y(), bottom + 1e-6);
  }
  EXPECT_LT(whole.focal_length, cropped.focal_length);
}

TEST(Rectification, IsExactlyTheIdentityForARectifiedRig) {
  const Rig rig = test::rectifiedRig();
  const Rectification rectification = computeRectification(rig, {});
  EXPECT_TRUE(rectification.is_identity);
  EXPECT_EQ(rectification.R_rectified_left, Eigen::Matrix3d::Identity());
  EXPECT_EQ(rectification.R_rectified_right, Eigen::Matrix3d::Identity());
  EXPECT_EQ(rectification.focal_length, 500.5);
  EXPECT_EQ(rectification.cx, 320.25);
  EXPECT_EQ(rectification.cy, 240.75);
  EXPECT_EQ(rectification.baseline, 0.12);
}

TEST(Rectification, RefusesSwappedCameras) {
  Rig rig = test::cartRig();
  std::swap(rig.left, rig.right);
  rig.T_right_left = rig.T_right_left.inverse();
  EXPECT_THAT(
      test::messageOf([&] { computeRectification(rig, {}); }),
      HasSubstr("rig 'cart': the right camera is to the left of the left one: the cameras are swapped"));
}

TEST(Rectification, RefusesCamerasAboveEachOther) {
  Rig rig = test::rectifiedRig();
  rig.T_right_left.translation() = Eigen::Vector3d(-0.01, -0.12, 0.0);
  EXPECT_THAT(test::messageOf([&] { computeRectification(rig, {}); }),
              HasSubstr("is not beside the left one"));
}

TEST(Rectification, RefusesDistortionThatFoldsWithinTheImage) {
  Rig rig = test::cartRig();
  rig.left.distortion = {-0.9};
  EXPECT_THAT(test::messageOf([&] { computeRectification(rig, {}); }),
              HasSubstr("distortion folds within the image"));
}

TEST(Rectification, RefusesAScalingBeyondOne) {
  EXPECT_THAT(test::messageOf([&] { computeRectification(test::cartRig(), {.free_scaling = 1.5}); }),
              HasSubstr("free_scaling must lie in 0 to 1"));
}

}  // namespace
}  // namespace cartvo::calib
