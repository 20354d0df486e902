// Reading of rig files of other tools.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "calib/format/kalibr_rig.hpp"
#include "calib/format/opencv_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "calib/format/rig_formats.hpp"
#include "calib/rectification/rectification.hpp"
#include "common/atomic_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"

namespace cartvo::calib {
namespace {

using ::testing::AllOf;
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
          << R << "T" << T << "image_size" << rig.left.size << "rms" << 0.2 << "E" << R << "calibration_time"
          << "Fri 27 Nov 2026 10:00:00 CET";
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

TEST(OpenCvRig, IsReadFromXmlAndJson) {
  const test::TemporaryFolder folder;
  for (const char* const name : {"stereo.xml", "stereo.json"}) {
    writeFileStorage(folder / name, test::cartRig());
    const Rig rig = readRig(folder / name);
    EXPECT_EQ(rig.left.size, cv::Size(680, 420));
    EXPECT_NEAR(rig.right.distortion[1], test::cartRig().right.distortion[1], 1e-12);
    EXPECT_TRUE(rig.T_right_left.isApprox(test::cartRig().T_right_left, 1e-12));
  }
  writeFileAtomically(folder / "other.xml", "<?xml version=\"1.0\"?>\n<html>\n");
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "other.xml"); }),
              HasSubstr("other.xml: is XML, but not"));
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
  std::string text = openCvText(test::cartRig());
  const std::size_t size = text.find("image_size");
  text.erase(size, text.find('\n', size) + 1 - size);
  writeFileAtomically(folder / "stereo.yml", text);
  EXPECT_THAT(test::messageOf([&] { readRig(folder / "stereo.yml"); }),
              HasSubstr("stereo.yml: image_size is missing; give --size WIDTHxHEIGHT"));
  EXPECT_EQ(readRigFiles({folder / "stereo.yml"}, {.image_size = cv::Size(680, 420)}).left.fx, 480.25);
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
              AllOf(HasSubstr("stereo.yml:4: D1: expected at most 8 coefficients"),
                    HasSubstr("coefficient 9 is 0.1")));
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
  const Rig rig = readRigFiles({folder / "calib.txt"}, {.image_size = cv::Size(1226, 370)});
  EXPECT_EQ(rig.left.fx, 707.0912);
  EXPECT_NEAR(rig.baseline(), 379.8145 / 707.0912, 1e-12);
  EXPECT_TRUE(computeRectification(rig, {}).is_identity);
}

TEST(KittiRig, UsesEveryNumberOfTheMatrices) {
  const test::TemporaryFolder folder;
  // KITTI's colour cameras: the last column is K times the translation.
  writeFileAtomically(folder / "calib.txt",
                      "P0: 707 0 601 0 0 707 183 0 0 0 1 0\n"
                      "P2: 707 0 601 46.89 0 707 183 0.1178 0 0 1 0.006203\n"
                      "P3: 707 0 601 -333.46 0 707 183 1.93 0 0 1 0.003201\n");
  const Rig rig =
      readRigFiles({folder / "calib.txt"}, {.image_size = cv::Size(1226, 370), .cameras = {2, 3}});
  EXPECT_NEAR(rig.T_right_left.translation().x(), (-333.46 - 46.89 - 601 * (0.003201 - 0.006203)) / 707,
              1e-12);
  EXPECT_NEAR(rig.T_right_left.translation().y(), (1.93 - 0.1178 - 183 * (0.003201 - 0.006203)) / 707, 1e-12);
  EXPECT_NEAR(rig.T_right_left.translation().z(), 0.003201 - 0.006203, 1e-12);
  writeFileAtomically(folder / "calib.txt",
                      "P0: 707 1 601 0 0 707 183 0 0 0 1 0\nP1: 707 0 601 -80 0 707 183 0 0 0 1 0\n");
  EXPECT_THAT(
      test::messageOf([&] { readRigFiles({folder / "calib.txt"}, {.image_size = cv::Size(1226, 370)}); }),
      HasSubstr("calib.txt:1: P0: expected the rows of [f 0 cx -f*b;"));
}

/// calib_cam_to_cam.txt with the right camera turned by 0.6 (sine) about the vertical axis.
constexpr const char* kRawCalibration =
    "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.95e-02\n"
    "S_00: 1392 512\nK_00: 984 0 690 0 981 233 0 0 1\nD_00: -0.37 0.2 0.0022 0.0014 -0.07\n"
    "R_00: 1 0 0 0 1 0 0 0 1\nT_00: 0 0 0\nS_rect_00: 1242 375\nP_rect_00: 721 0 609 0 0 721 172 0 0 0 1 0\n"
    "S_01: 1392 512\nK_01: 989 0 702 0 985 245 0 0 1\nD_01: -0.36 0.19 0.0017 -0.0003 -0.06\n"
    "R_01: 0.8 0 -0.6 0 1 0 0.6 0 0.8\nT_01: -0.537 0.005 -0.01\nS_rect_01: 1242 375\n"
    "P_rect_01: 721 0 609 -387.6 0 721 172 0 0 0 1 0\n";

TEST(KittiRig, IsReadFromRawRecordingsByTheSize) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder / "calib_cam_to_cam.txt";
  writeFileAtomically(file, kRawCalibration);
  EXPECT_THAT(
      test::messageOf([&] { readRigFiles({file}); }),
      HasSubstr("describes the raw images (1392x512) and the rectified ones (1242x375): give the size of "
                "yours by --size"));
  EXPECT_THAT(test::messageOf([&] { readRigFiles({file}, {.image_size = cv::Size(640, 480)}); }),
              HasSubstr("yours are 640x480, which is neither"));
  const Rig rectified = readRigFiles({file}, {.image_size = cv::Size(1242, 375)});
  EXPECT_EQ(rectified.left.fx, 721.0);
  EXPECT_NEAR(rectified.T_right_left.translation().x(), -387.6 / 721.0, 1e-12);
  const Rig raw = readRigFiles({file}, {.image_size = cv::Size(1392, 512), .unusual_geometry = true});
  EXPECT_TRUE(raw.unusual_geometry);
  EXPECT_EQ(raw.right.cx, 702.0);
  EXPECT_EQ(raw.right.distortion[4], -0.06);
  EXPECT_NEAR(raw.T_right_left.linear()(0, 2), -0.6, 1e-12);
  EXPECT_NEAR(raw.T_right_left.translation().z(), -0.01, 1e-12);
}

TEST(OpenCvRig, IsReadFromTheTwoFilesOfTheSample) {
  const test::TemporaryFolder folder;
  const std::string text = openCvText(test::cartRig());
  const std::size_t cameras = text.find("K1:"), pose = text.find("R: ");
  std::string intrinsics = "%YAML:1.0\n---\n" + text.substr(cameras, pose - cameras);
  for (char number : {'1', '2'})
    intrinsics.replace(intrinsics.find(std::string("K") + number), 1, "M");
  writeFileAtomically(folder / "intrinsics.yml", intrinsics);
  writeFileAtomically(folder / "extrinsics.yml", "%YAML:1.0\n---\n" + text.substr(pose));
  const std::vector<std::filesystem::path> files{folder / "intrinsics.yml", folder / "extrinsics.yml"};
  const Rig rig = readRigFiles(files, {.image_size = cv::Size(680, 420)});
  EXPECT_EQ(rig.right.cx, 336.5);
  EXPECT_TRUE(rig.T_right_left.isApprox(test::cartRig().T_right_left, 1e-12));
  EXPECT_THAT(test::messageOf([&] { readRigFiles({files[0]}); }),
              HasSubstr("intrinsics.yml: R is missing; if it is in another file"));
  EXPECT_THAT(test::messageOf([&] { readRigFiles(files); }), HasSubstr("image_size is missing"));
  writeFileAtomically(
      files[1], "%YAML:1.0\n---\n" + text.substr(pose) +
                    "P2: {rows: 3, cols: 4, data: [480, 0, 340, -110.4, 0, 480, 210, 0, 0, 0, 1, 0]}\n");
  EXPECT_THAT(test::messageOf([&] { readRigFiles(files, {.image_size = cv::Size(680, 420)}); }),
              HasSubstr("P2: gives a baseline of 0.23 m, and T one of 0.115"));
}

TEST(OpenCvRig, TakesWidthAndHeightAsTwoKeys) {
  const test::TemporaryFolder folder;
  std::string text = openCvText(test::cartRig());
  const std::size_t size = text.find("image_size");
  text.replace(size, text.find('\n', size) - size, "image_width: 680\nimage_height: 420");
  writeFileAtomically(folder / "stereo.yml", text);
  EXPECT_EQ(readRig(folder / "stereo.yml").left.size, cv::Size(680, 420));
  EXPECT_THAT(
      test::messageOf([&] { readRigFiles({folder / "stereo.yml"}, {.image_size = cv::Size(640, 480)}); }),
      HasSubstr("the file is for images of 680x420, not of 640x480"));
}

TEST(OpenCvRig, RefusesSkewAndTransposedMatrices) {
  const test::TemporaryFolder folder;
  const auto with = [&](const std::string& numbers) {
    std::string text = openCvText(test::cartRig());
    const std::size_t begin = text.find("data: [") + 7;
    writeFileAtomically(folder / "stereo.yml", text.replace(begin, text.find(']', begin) - begin, numbers));
    return test::messageOf([&] { readRig(folder / "stereo.yml"); });
  };
  EXPECT_THAT(with("480, 3.7, 340, 0, 481, 210, 0, 0, 1"), HasSubstr("K1: has a skew of 3.7 px"));
  EXPECT_THAT(with("480, 0, 0, 0, 481, 0, 340, 210, 1"),
              HasSubstr("K1: is transposed: the principal point (340, 210) is in the last row"));
  EXPECT_THAT(with("480, 0, 340, 0, 481, 210, 0, 0, 2"), HasSubstr("K1: expected [fx 0 cx; 0 fy cy; 0 0 1]"));
}

/// A FileStorage whose cameras both have these four coefficients, and the line `more` instead of
/// fisheye_model.
std::string withFourCoefficients(const std::string& numbers, const std::string& more = "") {
  std::string text = openCvText(test::cartRig());
  for (const char* const key : {"D1:", "D2:"}) {
    std::size_t begin = text.find("rows: ", text.find(key)) + 6;
    text[begin] = '4';
    begin = text.find("data: [", begin) + 7;
    text.replace(begin, text.find(']', begin) - begin, numbers);
  }
  const std::size_t flag = text.find("fisheye_model");
  return text.replace(flag, text.find('\n', flag) - flag, more);
}

TEST(OpenCvRig, AsksForTheLensModelOfFourCoefficients) {
  const auto message_of = [](const std::string& numbers) {
    return test::messageOf([&] { parseRig(withFourCoefficients(numbers), "stereo.yml"); });
  };
  EXPECT_EQ(message_of("-0.3, 0.1, 0.0004, -0.0003"), "") << "stronger than any fisheye lens";
  EXPECT_EQ(message_of("0, 0, 0, 0"), "");
  for (const char* const numbers : {"-0.03, 0.01, -0.02, 0.004", "-0.0312, 0.0061, -0.0058, 0.0011",
                                    "0.0214, -0.0087, 0.0042, -0.0019", "-0.121, 0.015, -0.009, 0.0021"})
    EXPECT_THAT(message_of(numbers),
                AllOf(HasSubstr("D1: has four coefficients ["), HasSubstr("fisheye_model")));
}

TEST(OpenCvRig, TakesTheLensModelFromNamesInTheFile) {
  const auto rig_with = [](const std::string& line, const char* name = "stereo.yml") {
    return parseRig(withFourCoefficients("-0.0312, 0.0061, -0.0058, 0.0011", line), name);
  };
  for (const char* const line : {"fisheye_model: 1", "distortion_model: equidistant",
                                 "camera_model: cv::fisheye", "model_type: KANNALA_BRANDT"})
    EXPECT_EQ(rig_with(line).left.lens, LensModel::wide) << line;
  for (const char* const line : {"fisheye_model: 0", "distortion_model: radtan", "camera_model: Pinhole"})
    EXPECT_EQ(rig_with(line).right.lens, LensModel::brown) << line;
  EXPECT_EQ(rig_with("", "stereo_Fisheye.yml").left.lens, LensModel::wide);
  EXPECT_THAT(test::messageOf([&] { rig_with("camera_model: scaramuzza"); }),
              HasSubstr("camera_model: expected a pinhole with Brown's distortion"));
  EXPECT_THAT(test::messageOf([&] { rig_with("xi1: 1.2"); }),
              HasSubstr("xi1: belongs to an omnidirectional lens"));
}

TEST(OpenCvRig, TakesMatricesAsRowsOfNumbers) {
  const Rig rig = parseRig(R"({"image_size": [640, 480],
    "K1": [[500, 0, 320], [0, 501, 240], [0, 0, 1]], "D1": [[-0.3, 0.1, 0.001, 0.0, 0.0]],
    "K2": [[502, 0, 320], [0, 503, 240], [0, 0, 1]], "D2": [[-0.3, 0.1, 0.001, 0.0, 0.0]],
    "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "T": [[-0.12], [0], [0]]})",
                           "stereo.json");
  EXPECT_EQ(rig.right.fy, 503.0);
  EXPECT_EQ(rig.T_right_left.translation(), Eigen::Vector3d(-0.12, 0.0, 0.0));
}

TEST(RigFiles, NameOtherToolsAndUnknownFormats) {
  const test::TemporaryFolder folder;
  const auto message_of = [&](const std::string& name, const std::string& text) {
    writeFileAtomically(folder / name, text);
    const std::string message = test::messageOf([&] { readRigFiles({folder / name}); });
    EXPECT_THAT(message, HasSubstr(name + ": is "));
    return message;
  };
  EXPECT_THAT(message_of("stereo.mat", "MATLAB 5.0 MAT-file, Platform: GLNXA64"),
              HasSubstr("is of MATLAB (binary), a format that is not read: write the parameters as JSON"));
  EXPECT_THAT(message_of("SN1234.conf", "[LEFT_CAM_HD]\nfx=700\n\n[RIGHT_CAM_HD]\nfx=700\n"),
              AllOf(HasSubstr("is of a ZED,"), HasSubstr("camera_info")));
  EXPECT_THAT(message_of("rig.yaml", "%YAML:1.0\nCamera.bf: 47.9\nLEFT.K: x\n   data:[1]\n"),
              AllOf(HasSubstr("is of ORB-SLAM2,"), HasSubstr("LEFT.K LEFT.D")));
  EXPECT_THAT(message_of("left.cameramodel", "{ 'lensmodel': 'LENSMODEL_OPENCV8' }"),
              HasSubstr("mrcal-to-kalibr"));
  EXPECT_THAT(message_of("basalt.json", R"({"value0": {"T_imu_cam": []}})"), HasSubstr("is of Basalt,"));
  EXPECT_THAT(message_of("cameras.bin", std::string("\2\0\0\0", 4)), HasSubstr("is of COLMAP,"));
  EXPECT_THAT(message_of("rig.npz", std::string("PK\3\4\0\0", 6)), HasSubstr("cv2.FileStorage"));
  EXPECT_THAT(message_of("rig.bin", std::string("\1\2\0\0", 4)),
              HasSubstr("is a binary file; expected cartvo's"));
  EXPECT_THAT(message_of("other.ini", "[left]\nfx=700\n[right]\nfx=700\n"),
              AllOf(HasSubstr("is in none of the known formats"), HasSubstr("read as YAML:")));
  const std::string message = message_of("other.yaml", "cameras: 2\n");
  EXPECT_THAT(message, HasSubstr("is in none of the known formats: cartvo's rig.yaml"));
  EXPECT_THAT(message, testing::Not(HasSubstr("calibrate convert")));
}

/// A message of the topic camera_info; `Tx` of its P.
std::string rosMessage(double Tx) {
  const std::string P = "[383.1, 0, 319.8, " + std::to_string(Tx) + ", 0, 383.1, 241.6, 0, 0, 0, 1, 0]\n";
  return "header:\n  frame_id: x\nheight: 480\nwidth: 640\ndistortion_model: plumb_bob\nD: [0, 0, 0, 0, 0]\n"
         "K: [383.1, 0, 319.8, 0, 383.1, 241.6, 0, 0, 1]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nP: " +
         P + "roi: {x_offset: 0, y_offset: 0, height: 480, width: 640, do_rectify: false}\n";
}

TEST(RosRig, IsReadFromMessagesOfTheTopic) {
  const test::TemporaryFolder folder;
  const std::string left = rosMessage(0.0), right = rosMessage(-19.155);
  writeFileAtomically(folder / "left.yaml", left + "---\n" + left);
  writeFileAtomically(folder / "right.yaml", right + "---\n");
  const Rig rig = readRigFiles({folder / "left.yaml", folder / "right.yaml"});
  EXPECT_EQ(rig.left.size, cv::Size(640, 480));
  EXPECT_EQ(rig.left.fx, 383.1);
  EXPECT_NEAR(rig.baseline(), 0.05, 1e-9);
  EXPECT_THAT(test::messageOf([&] { readRigFiles({folder / "left.yaml"}); }),
              HasSubstr("holds one camera only"));
}

TEST(RosRig, NamesTheNumberOfABaselineThatIsMissing) {
  const test::TemporaryFolder folder;
  for (const double Tx : {0.0, -19.155}) {
    writeFileAtomically(folder / "left.yaml", rosMessage(Tx));
    writeFileAtomically(folder / "right.yaml", rosMessage(Tx));
    EXPECT_THAT(test::messageOf([&] {
                  readRigFiles({folder / "left.yaml", folder / "right.yaml"});
                }),
                HasSubstr("projection_matrix (P): Tx, its fourth number, is that of the left camera"));
  }
}

TEST(KittiRig, RefusesAShortRowAndAMissingRow) {
  const test::TemporaryFolder folder;
  writeFileAtomically(folder / "calib.txt", "P0: 707 0 601 0 0 707 183 0 0 0 1 0\nP1: 707 0 601\n");
  EXPECT_THAT(
      test::messageOf([&] { readRigFiles({folder / "calib.txt"}, {.image_size = cv::Size(1226, 370)}); }),
      HasSubstr("calib.txt:2: P1: expected 12 numbers"));
  writeFileAtomically(folder / "calib.txt", "P0: 707 0 601 0 0 707 183 0 0 0 1 0\n");
  EXPECT_THAT(
      test::messageOf([&] { readRigFiles({folder / "calib.txt"}, {.image_size = cv::Size(1226, 370)}); }),
      HasSubstr("calib.txt:1: P1 is missing"));
}

}  // namespace
}  // namespace cartvo::calib
