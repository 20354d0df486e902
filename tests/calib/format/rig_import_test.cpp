// Reading of rig files of other tools.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "calib/format/euroc_rig.hpp"
#include "calib/format/kitti_rig.hpp"
#include "calib/format/opencv_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "calib/rectification/rectification.hpp"
#include "common/atomic_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"

namespace cartvo::calib {
namespace {

using ::testing::HasSubstr;

/// Writes a rig as OpenCV's own FileStorage does.
void writeFileStorage(const std::filesystem::path& file, const Rig& rig) {
  cv::FileStorage storage(file.string(), cv::FileStorage::WRITE);
  const auto K = [](const CameraModel& camera) {
    return cv::Mat(cv::Matx33d(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1));
  };
  const auto D = [](const CameraModel& camera) {
    return cv::Mat(1, 5, CV_64F, const_cast<double*>(camera.distortion.data())).clone();
  };
  cv::Mat R(3, 3, CV_64F), T(3, 1, CV_64F);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      R.at<double>(i, j) = rig.T_right_left.linear()(i, j);
    T.at<double>(i) = rig.T_right_left.translation()[i];
  }
  storage << "K1" << K(rig.left) << "D1" << D(rig.left) << "K2" << K(rig.right) << "D2" << D(rig.right) << "R"
          << R << "T" << T << "image_size" << rig.left.size << "rms" << 0.2 << "E" << R;
}

TEST(OpenCvRig, IsReadFromFileStorage) {
  const test::TemporaryFolder folder;
  const Rig expected = test::cartRig();
  writeFileStorage(folder / "stereo.yml", expected);
  const Rig rig = readRig(folder / "stereo.yml");
  EXPECT_EQ(rig.name, "stereo");
  EXPECT_EQ(rig.left.size, expected.left.size);
  EXPECT_EQ(rig.left.fx, expected.left.fx);
  EXPECT_EQ(rig.right.cy, expected.right.cy);
  EXPECT_EQ(rig.left.distortion, expected.left.distortion);
  EXPECT_TRUE(rig.T_right_left.isApprox(expected.T_right_left, 1e-12));
  EXPECT_EQ(rig.T_body_camera.matrix(), forwardLookingMount().matrix());
}

TEST(OpenCvRig, RefusesMillimetres) {
  const test::TemporaryFolder folder;
  Rig millimetres = test::cartRig();
  millimetres.T_right_left.translation() *= 1000.0;
  writeFileStorage(folder / "stereo.yml", millimetres);
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "stereo.yml"); }),
              HasSubstr("was the board's square given in millimetres?"));
}

TEST(OpenCvRig, RefusesAFileWithoutImageSize) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "stereo.yml", "%YAML:1.0\n---\nK1: 1\n");
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "stereo.yml"); }),
              HasSubstr("stereo.yml:3: image_size: expected this key, which is missing"));
}

TEST(OpenCvRig, RefusesThinPrismCoefficients) {
  const test::TemporaryFolder folder;
  const std::string matrix =
      "!!opencv-matrix {rows: 3, cols: 3, dt: d, data: [500., 0., 320., 0., 500., 240., 0., 0., 1.]}\n";
  writeFileAtomically(
      folder / "stereo.yml",
      "%YAML:1.0\nimage_size: [640, 480]\nK1: " + matrix +
          "D1: !!opencv-matrix {rows: 1, cols: 12, dt: d, data: [0,0,0,0,0,0,0,0,0.1,0,0,0]}\n");
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "stereo.yml"); }),
              HasSubstr("stereo.yml:4: D1: expected at most 8 coefficients"));
}

TEST(EurocRig, IsReadFromTwoSensorFiles) {
  CARTVO_NEEDS_DATA(folder, "euroc_still");
  const Rig rig = readEurocRig(folder / "mav0/cam0/sensor.yaml", folder / "mav0/cam1/sensor.yaml");
  EXPECT_EQ(rig.left.size, cv::Size(752, 480));
  EXPECT_EQ(rig.left.fx, 458.654);
  EXPECT_EQ(rig.right.cy, 255.238);
  EXPECT_EQ(rig.left.distortion[3], 1.76187114e-05);
  EXPECT_NEAR(rig.baseline(), 0.110, 0.001);
  EXPECT_LT(rig.T_right_left.translation().x(), -0.109);
  EXPECT_LT(Eigen::AngleAxisd(rig.T_right_left.linear()).angle(), 0.03);
  EXPECT_NO_THROW(computeRectification(rig, {}));
}

TEST(EurocRig, RefusesAnotherCameraModel) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "sensor.yaml", "camera_model: omni\n");
  EXPECT_THAT(test::messageOf([&] { readEurocRig(folder / "sensor.yaml", folder / "sensor.yaml"); }),
              HasSubstr("sensor.yaml:1: camera_model: expected 'pinhole', found 'omni'"));
}

TEST(KittiRig, IsReadFromCalibTxt) {
  CARTVO_NEEDS_DATA(folder, "kitti_06");
  const Rig rig = readKittiRig(folder / "calib.txt", {1226, 370});
  EXPECT_EQ(rig.left.fx, 707.0912);
  EXPECT_NEAR(rig.baseline(), 379.8145 / 707.0912, 1e-12);
  EXPECT_TRUE(computeRectification(rig, {}).is_identity);
}

TEST(KittiRig, RefusesAShortRowAndAMissingRow) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "calib.txt", "P0: 707 0 601 0 0 707 183 0 0 0 1 0\nP1: 707 0 601\n");
  EXPECT_THAT(test::messageOf([&] {
                readKittiRig(folder / "calib.txt", {1226, 370});
              }),
              HasSubstr("calib.txt:2: P1: expected 12 numbers"));
  writeFileAtomically(folder / "calib.txt", "P0: 707 0 601 0 0 707 183 0 0 0 1 0\n");
  EXPECT_THAT(test::messageOf([&] {
                readKittiRig(folder / "calib.txt", {1226, 370});
              }),
              HasSubstr("expected the lines 'P0: ...' and 'P1: ...'"));
}

}  // namespace
}  // namespace cartvo::calib
