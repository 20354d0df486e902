// Rig formats of other tools: round trips, errors, and the meaning of their values.
#include "calib/format/rig_formats.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "calib/format/opencv_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "common/atomic_file.hpp"
#include "common/strict_yaml.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::calib {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr double kTolerance = 1e-12;

/// Writes a rig's files and returns their paths.
std::vector<fs::path> writeFiles(const test::TemporaryFolder& folder, const Rig& rig, RigFormat format) {
  std::vector<fs::path> paths;
  for (const RigFile& file : rigFilesOf(rig, format)) {
    paths.push_back(folder.path() / (file.name.empty() ? fs::path("rig.txt") : file.name));
    fs::create_directories(paths.back().parent_path());
    writeFileAtomically(paths.back(), file.text);
  }
  return paths;
}

void expectSameCamera(const CameraModel& read, const CameraModel& written) {
  EXPECT_EQ(read.size, written.size);
  EXPECT_EQ(read.lens, written.lens);
  EXPECT_NEAR(read.fx, written.fx, kTolerance * written.fx);
  EXPECT_NEAR(read.fy, written.fy, kTolerance * written.fy);
  EXPECT_NEAR(read.cx, written.cx, kTolerance * written.cx);
  EXPECT_NEAR(read.cy, written.cy, kTolerance * written.cy);
  for (std::size_t i = 0; i < written.distortion.size(); ++i)
    EXPECT_NEAR(read.distortion[i], written.distortion[i], kTolerance);
}

/// A rig without k3, which radtan does not have.
Rig fourCoefficients() {
  Rig rig = test::cartRig();
  rig.left.distortion[4] = rig.right.distortion[4] = 0.0;
  return rig;
}

Rig rationalRig() {
  Rig rig = test::cartRig();
  rig.left.distortion = {0.3, 0.02, 0.0004, -0.0003, 0.001, 0.6, 0.07, 0.003};
  return rig;
}

struct RoundTrip {
  std::string name;
  RigFormat format;
  Rig rig;
};

void PrintTo(const RoundTrip& trip, std::ostream* stream) {
  *stream << trip.name;
}

class RigRoundTrip : public ::testing::TestWithParam<RoundTrip> {};

TEST_P(RigRoundTrip, ReturnsTheSameRig) {
  const auto& [name, format, rig] = GetParam();
  const test::TemporaryFolder folder;
  const Rig read = readRigFiles(writeFiles(folder, rig, format), {.image_size = rig.left.size});
  expectSameCamera(read.left, rig.left);
  expectSameCamera(read.right, rig.right);
  EXPECT_TRUE(read.T_right_left.matrix().isApprox(rig.T_right_left.matrix(), kTolerance))
      << read.T_right_left.matrix() - rig.T_right_left.matrix();
  const Eigen::Isometry3d mount = format == RigFormat::cartvo ? rig.T_body_camera : forwardLookingMount();
  EXPECT_EQ(read.T_body_camera.matrix(), mount.matrix());
}

INSTANTIATE_TEST_SUITE_P(, RigRoundTrip,
                         ::testing::Values(RoundTrip{"Own", RigFormat::cartvo, test::cartRig()},
                                           RoundTrip{"OpenCv", RigFormat::opencv, rationalRig()},
                                           RoundTrip{"OpenCvFisheye", RigFormat::opencv, test::wideRig()},
                                           RoundTrip{"Kalibr", RigFormat::kalibr, fourCoefficients()},
                                           RoundTrip{"KalibrEquidistant", RigFormat::kalibr, test::wideRig()},
                                           RoundTrip{"Matlab", RigFormat::matlab, test::cartRig()},
                                           RoundTrip{"Kitti", RigFormat::kitti, test::rectifiedRig()},
                                           RoundTrip{"Ros", RigFormat::ros, test::cartRig()},
                                           RoundTrip{"RosRational", RigFormat::ros, rationalRig()},
                                           RoundTrip{"RosEquidistant", RigFormat::ros, test::wideRig()},
                                           RoundTrip{"RosRectified", RigFormat::ros, test::rectifiedRig()},
                                           RoundTrip{"Euroc", RigFormat::euroc, fourCoefficients()},
                                           RoundTrip{"EurocEquidistant", RigFormat::euroc, test::wideRig()}),
                         [](const auto& test_case) { return test_case.param.name; });

TEST(RigFormats, NameTheReasonIfTheyCannotRepresentARig) {
  const auto problem = [](const Rig& rig, RigFormat format) {
    return test::messageOf([&] { rigFilesOf(rig, format); });
  };
  EXPECT_THAT(problem(test::cartRig(), RigFormat::kalibr),
              HasSubstr("Kalibr's radtan model holds the first 4 of the distortion coefficients"));
  EXPECT_THAT(problem(test::cartRig(), RigFormat::euroc), HasSubstr("holds the first 4"));
  EXPECT_THAT(problem(rationalRig(), RigFormat::matlab), HasSubstr("holds the first 5"));
  EXPECT_THAT(problem(test::wideRig(), RigFormat::matlab), HasSubstr("this rig's lenses are wide"));
  EXPECT_THAT(problem(test::cartRig(), RigFormat::kitti), HasSubstr("this rig's are raw"));
  Rig mixed = test::cartRig();
  mixed.right = test::wideRig().right;
  EXPECT_THAT(problem(mixed, RigFormat::opencv), HasSubstr("holds one lens model; this rig has two"));
}

TEST(RigFormats, HaveNames) {
  for (const std::string& name : rigFormatNames())
    EXPECT_EQ(rigFormatNames()[static_cast<std::size_t>(parseRigFormat(name))], name);
  EXPECT_EQ(parseRigFormat("euroc"), RigFormat::euroc);
  EXPECT_THROW(parseRigFormat("excel"), std::invalid_argument);
}

TEST(RigFormats, RefuseMissingFilesAndAMissingSize) {
  const test::TemporaryFolder folder;
  const std::vector<fs::path> files = writeFiles(folder, test::cartRig(), RigFormat::ros);
  EXPECT_THAT(test::messageOf([&] { readRigFiles({files[0]}, {}); }), HasSubstr("holds one camera only"));
  const std::vector<fs::path> own = writeFiles(folder, test::cartRig(), RigFormat::cartvo);
  EXPECT_THAT(test::messageOf([&] {
                readRigFiles({own[0], own[0]}, {});
              }),
              HasSubstr("two files are OpenCV's intrinsics (K1 or M1) and extrinsics (R, T)"));
  const std::vector<fs::path> kitti = writeFiles(folder, test::rectifiedRig(), RigFormat::kitti);
  EXPECT_THAT(test::messageOf([&] { readRigFiles(kitti, {}); }), HasSubstr("give it by --size"));
}

TEST(OpenCvText, IsReadByOpenCv) {
  const test::TemporaryFolder folder;
  const Rig rig = test::wideRig();
  const cv::FileStorage storage(writeFiles(folder, rig, RigFormat::opencv)[0].string(),
                                cv::FileStorage::READ);
  cv::Mat K, D, T;
  cv::Size size;
  storage["K2"] >> K;
  storage["D2"] >> D;
  storage["T"] >> T;
  storage["image_size"] >> size;
  EXPECT_EQ(size, rig.left.size);
  EXPECT_EQ(K.at<double>(1, 2), rig.right.cy);
  EXPECT_EQ(D.at<double>(3), rig.right.distortion[3]);
  EXPECT_EQ(T.at<double>(0), rig.T_right_left.translation().x());
}

/// The pixel of a point (camera axes) in the camera's own rectified image by ROS. The baseline term of P
/// applies only to points in the left camera's axes and is not used.
Eigen::Vector2d rectifiedPixel(const RigFile& file, const Eigen::Vector3d& in_camera) {
  const StrictYaml yaml = StrictYaml::parse(file.text, file.name);
  const std::vector<double> R = yaml["rectification_matrix"]["data"].numbers(9);
  const std::vector<double> P = yaml["projection_matrix"]["data"].numbers(12);
  const Eigen::Vector3d in_rectified =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data()) * in_camera;
  return {P[0] * in_rectified.x() / in_rectified.z() + P[2],
          P[5] * in_rectified.y() / in_rectified.z() + P[6]};
}

TEST(RosText, RectifiesAPointIntoOneRowWithTheDisparityOfItsDepth) {
  const Rig rig = test::cartRig();
  const std::vector<RigFile> files = rigFilesOf(rig, RigFormat::ros);
  const Eigen::Vector3d point(0.4, -0.2, 5.0);
  const Eigen::Vector2d left = rectifiedPixel(files[0], point);
  const Eigen::Vector2d right = rectifiedPixel(files[1], rig.T_right_left * point);
  EXPECT_NEAR(left.y(), right.y(), 1e-9);
  const StrictYaml yaml = StrictYaml::parse(files[1].text, files[1].name);
  const double minus_fb = yaml["projection_matrix"]["data"].numbers(12)[3];
  const std::vector<double> R =
      StrictYaml::parse(files[0].text, "left")["rectification_matrix"]["data"].numbers(9);
  const double depth = R[6] * point.x() + R[7] * point.y() + R[8] * point.z();
  EXPECT_NEAR(left.x() - right.x(), -minus_fb / depth, 1e-9);
}

/// A camchain in Kalibr's own formatting, with a baseline of 11 cm.
constexpr const char* kCamchain = R"(cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.8e-05]
  distortion_model: radtan
  intrinsics: [458.0, 457.0, 367.0, 248.0]
  resolution: [752, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.11]
  - [0.0, 1.0, 0.0, 0.001]
  - [0.0, 0.0, 1.0, 0.002]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 1.8e-05]
  distortion_model: radtan
  intrinsics: [457.0, 456.0, 379.0, 255.0]
  resolution: [752, 480]
  rostopic: /cam1/image_raw
)";

std::string camchainWith(const std::string& replaced, const std::string& by) {
  std::string text = kCamchain;
  return text.replace(text.rfind(replaced), replaced.size(), by);
}

TEST(KalibrRig, IsReadFromACamchain) {
  const Rig rig = parseRig(kCamchain, "camchain.yaml");
  EXPECT_EQ(rig.left.cx, 367.0);
  EXPECT_EQ(rig.right.fy, 456.0);
  EXPECT_EQ(rig.left.distortion[3], 1.8e-05);
  EXPECT_EQ(rig.T_right_left.translation(), Eigen::Vector3d(-0.11, 0.001, 0.002));
}

TEST(KalibrRig, IsReadByTheTransformsAgainstTheImu) {
  const std::string left =
      "cam0:\n  T_cam_imu: [[0, -1, 0, 0], [0, 0, -1, 0.01], [1, 0, 0, -0.02], [0, 0, 0, 1]]";
  const std::string right =
      "  T_cam_imu: [[0, -1, 0, -0.11], [0, 0, -1, 0.011], [1, 0, 0, -0.018], [0, 0, 0, 1]]\n";
  std::string text = kCamchain;
  text.replace(0, 5, left);
  const std::size_t chain = text.find("  T_cn_cnm1:");
  const std::string both = text.substr(0, chain) + right + text.substr(chain);
  EXPECT_EQ(parseRig(both, "c.yaml").T_right_left.translation(), Eigen::Vector3d(-0.11, 0.001, 0.002));
  const std::string by_imu = text.substr(0, chain) + right + text.substr(text.find("  cam_overlaps: [0]"));
  EXPECT_TRUE(
      parseRig(by_imu, "c.yaml").T_right_left.translation().isApprox(Eigen::Vector3d(-0.11, 0.001, 0.002)));
  std::string other = both;
  other.replace(other.find("0, -0.11]"), 9, "0, -0.12]");
  EXPECT_THAT(
      test::messageOf([&] { parseRig(other, "c.yaml"); }),
      HasSubstr("cam1.T_cn_cnm1: differs from the transform that both cameras' transforms against the IMU"));
  const std::string without = text.substr(0, chain) + text.substr(text.find("  cam_overlaps: [0]"));
  EXPECT_THAT(test::messageOf([&] { parseRig(without, "c.yaml"); }),
              HasSubstr("cam1: has no T_cn_cnm1 (against cam0), nor have both cameras T_cam_imu"));
}

TEST(KalibrRig, RefusesFaultyFilesNamingLineAndKey) {
  const auto problem = [](const std::string& text) {
    return test::messageOf([&] { parseRig(text, "chain.yaml"); });
  };
  EXPECT_THAT(problem(camchainWith("pinhole", "omni")),
              HasSubstr("chain.yaml:16: cam1.camera_model: expected 'pinhole', found 'omni'"));
  EXPECT_THAT(problem(camchainWith("radtan", "fov")),
              HasSubstr("cam1.distortion_model: expected radtan, equidistant or none, found 'fov'"));
  EXPECT_THAT(problem(camchainWith("  - [0.0, 0.0, 0.0, 1.0]\n", "")),
              HasSubstr("cam1.T_cn_cnm1: expected a sequence of 16 numbers"));
  EXPECT_THAT(problem(camchainWith("[0.0, 1.0, 0.0, 0.001]", "[0.1, 1.0, 0.0, 0.001]")),
              HasSubstr("cam1.T_cn_cnm1: expected a rotation with orthonormal rows"));
  EXPECT_THAT(problem(camchainWith("[752, 480]", "[640, 480]")), HasSubstr("must have the same image size"));
}

/// MATLAB's parameters of two cameras, the second rotated about its z axis; row vectors are multiplied from
/// the left.
TEST(MatlabRig, IsReadTransposedWithPixelsFromOneAndMillimetres) {
  const std::string camera = R"({"IntrinsicMatrix": [[500, 0, 0], [0, 501, 0], [321, 241, 1]],
    "RadialDistortion": [-0.3, 0.1], "TangentialDistortion": [0.001, 0.002], "ImageSize": [480, 640],
    "EstimateSkew": false})";
  const std::string text = "{\"CameraParameters1\": " + camera + ", \"CameraParameters2\": " + camera +
                           R"(, "RotationOfCamera2": [[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]],
    "TranslationOfCamera2": [-115, 2, 1]})";
  const Rig rig = parseMatlabRig(StrictYaml::parse(text, "stereo.json"), "stereo.json");
  EXPECT_EQ(rig.left.size, cv::Size(640, 480));
  EXPECT_EQ(rig.left.fy, 501.0);
  EXPECT_EQ(rig.left.cx, 320.0);
  EXPECT_EQ(rig.left.cy, 240.0);
  EXPECT_EQ(rig.left.distortion[1], 0.1);
  EXPECT_EQ(rig.left.distortion[2], 0.001);
  EXPECT_EQ(rig.left.distortion[4], 0.0);
  Eigen::Matrix3d R;
  R << 0.8, 0.6, 0.0, -0.6, 0.8, 0.0, 0.0, 0.0, 1.0;
  const Eigen::RowVector3d in_left(300.0, 200.0, 2000.0);
  const Eigen::RowVector3d in_right = in_left * R + Eigen::RowVector3d(-115.0, 2.0, 1.0);
  const Eigen::Vector3d ours = rig.T_right_left * Eigen::Vector3d(0.3, 0.2, 2.0);
  EXPECT_TRUE(ours.isApprox(in_right.transpose() / 1000.0, 1e-12));
}

TEST(MatlabRig, RefusesMatricesThatAreNotTransposed) {
  const test::TemporaryFolder folder;
  std::string text = rigFilesOf(test::cartRig(), RigFormat::matlab)[0].text;
  const std::size_t begin = text.find("[[");
  text.replace(begin, text.find("]]", begin) + 2 - begin, "[[500, 0, 320], [0, 500, 240], [0, 0, 1]]");
  EXPECT_THAT(
      test::messageOf([&] { parseRig(text, "stereo.json"); }),
      HasSubstr("stereo.json:3: CameraParameters1.IntrinsicMatrix: expected [fx 0 0; skew fy 0; cx cy 1], as "
                "MATLAB writes it: exchange rows and columns"));
}

TEST(RosRig, RefusesNumbersThatAreNotUsed) {
  const test::TemporaryFolder folder;
  const auto with = [&](const std::string& key, std::size_t index, const std::string& value) {
    const std::vector<fs::path> files = writeFiles(folder, test::cartRig(), RigFormat::ros);
    std::string text = rigFilesOf(test::cartRig(), RigFormat::ros)[1].text;
    std::size_t begin = text.find('[', text.find(key)) + 1;
    for (; index > 0; --index)
      begin = text.find(' ', begin) + 1;
    writeFileAtomically(files[1], text.replace(begin, text.find_first_of(",]", begin) - begin, value));
    return test::messageOf([&] { readRigFiles(files); });
  };
  EXPECT_THAT(with("camera_matrix", 1, "2.5"), HasSubstr("camera_matrix: has a skew of 2.5 px"));
  EXPECT_THAT(with("projection_matrix", 1, "2.5"),
              HasSubstr("projection_matrix: expected the rows of [f 0 cx"));
  EXPECT_THAT(with("projection_matrix", 7, "2.5"),
              HasSubstr("projection_matrix: expected a camera beside the other"));
  EXPECT_THAT(with("projection_matrix", 6, "2.5"),
              HasSubstr("the two files are not of one stereo calibration"));
}

TEST(RosRig, RefusesAPartOfTheImage) {
  const test::TemporaryFolder folder;
  const std::vector<fs::path> files = writeFiles(folder, test::cartRig(), RigFormat::ros);
  const std::string text = rigFilesOf(test::cartRig(), RigFormat::ros)[1].text;
  const auto with = [&](const std::string& more) {
    writeFileAtomically(files[1], text + more);
    return test::messageOf([&] { readRigFiles(files); });
  };
  EXPECT_EQ(with("binning_x: 0\nroi: {x_offset: 0, width: 0}\n"), "");
  EXPECT_THAT(with("binning_y: 2\n"), HasSubstr("binning_y: images with binning are not read"));
  EXPECT_THAT(with("roi: {x_offset: 16}\n"), HasSubstr("roi.x_offset: a region of interest is not read"));
}

TEST(RosRig, RefusesFaultyFilesNamingFileLineAndKey) {
  const test::TemporaryFolder folder;
  const std::vector<fs::path> files = writeFiles(folder, test::cartRig(), RigFormat::ros);
  std::string text = rigFilesOf(test::cartRig(), RigFormat::ros)[1].text;
  writeFileAtomically(files[1], text.replace(text.find("plumb_bob"), 9, "pinhole"));
  EXPECT_THAT(
      test::messageOf([&] { readRigFiles(files, {}); }),
      HasSubstr("right.yaml:8: distortion_model: expected plumb_bob, rational_polynomial or equidistant, "
                "found 'pinhole'"));
}

}  // namespace
}  // namespace cartvo::calib
