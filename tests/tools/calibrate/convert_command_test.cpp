// The command `cartvo calibrate convert`.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string in(const test::TemporaryFolder& folder, const char* name) {
  return (folder / name).string();
}

TEST(CalibrateConvertCommand, WritesAPairOfFilesAndReadsThemBack) {
  const test::TemporaryFolder folder;
  calib::writeRig(folder / "rig.yaml", test::wideRig());
  const test::CommandResult out = test::runCartvo("calibrate convert " + in(folder, "rig.yaml") +
                                                  " --format ros --output " + in(folder, "camera_info"));
  ASSERT_EQ(out.exit_code, 0) << out.output;
  EXPECT_THAT(out.output, HasSubstr("camera_info/right.yaml"));
  EXPECT_THAT(out.output, HasSubstr("680x420 px, baseline 0.1150 m"));
  const test::CommandResult back =
      test::runCartvo("calibrate convert " + in(folder, "camera_info/left.yaml") + " " +
                      in(folder, "camera_info/right.yaml") + " --output " + in(folder, "back.yaml"));
  ASSERT_EQ(back.exit_code, 0) << back.output;
  EXPECT_TRUE(
      calib::readRig(folder / "back.yaml").T_right_left.isApprox(test::wideRig().T_right_left, 1e-12));
}

TEST(CalibrateConvertCommand, PrintsJson) {
  const test::TemporaryFolder folder;
  calib::writeRig(folder / "rig.yaml", test::wideRig());
  const auto json =
      nlohmann::json::parse(test::pipeCartvo("calibrate convert " + in(folder, "rig.yaml") +
                                             " --format ros --json --output " + in(folder, "camera_info"))
                                .output);
  EXPECT_EQ(json["format"], "ros");
  EXPECT_EQ(json["files"].size(), 2U);
  EXPECT_NEAR(json["baseline_m"].get<double>(), 0.115, 1e-4);
}

TEST(CalibrateConvertCommand, WarnsThatOtherFormatsLoseTheScaleStddev) {
  const test::TemporaryFolder folder;
  calib::Rig rig = test::rectifiedRig();
  const auto said_of = [&](const char* format) {
    calib::writeRig(folder / "rig.yaml", rig);
    return test::runCartvo("calibrate convert " + in(folder, "rig.yaml") + " --format " + format +
                           " --output " + in(folder, "out.yaml"))
        .output;
  };
  EXPECT_THAT(said_of("opencv"), Not(HasSubstr("scale")));
  rig.scale_stddev = 0.002;
  EXPECT_THAT(said_of("opencv"), HasSubstr("the format opencv cannot store the scale's uncertainty"));
  EXPECT_EQ(calib::readRig(folder / "out.yaml").scale_stddev, 0.0) << "read as opencv's";
  EXPECT_THAT(said_of("cartvo"), Not(HasSubstr("scale")));
  EXPECT_EQ(calib::readRig(folder / "out.yaml").scale_stddev, 0.002);
}

TEST(CalibrateConvertCommand, NamesTheNextStepWhileTheMountIsNotKnown) {
  const test::TemporaryFolder folder;
  const auto said_of = [&](const calib::Rig& rig) {
    calib::writeRig(folder / "rig.yaml", rig);
    return test::runCartvo("calibrate convert " + in(folder, "rig.yaml") + " --output " +
                           in(folder, "new.yaml"))
        .output;
  };
  EXPECT_THAT(said_of(test::rectifiedRig()), HasSubstr("next: record a straight drive"));
  EXPECT_THAT(said_of(test::cartRig()), Not(HasSubstr("next:")));
}

TEST(CalibrateConvertCommand, ReadsEurocAndKittiFiles) {
  CARTVO_NEEDS_DATA(euroc, "euroc_still");
  CARTVO_NEEDS_DATA(kitti, "kitti_06");
  const test::TemporaryFolder folder;
  const std::string mav = (euroc / "mav0").string();
  const test::CommandResult from_euroc =
      test::runCartvo("calibrate convert " + mav + "/cam0/sensor.yaml " + mav +
                      "/cam1/sensor.yaml --format kalibr --output " + in(folder, "camchain.yaml"));
  EXPECT_EQ(from_euroc.exit_code, 0) << from_euroc.output;
  EXPECT_EQ(calib::readRig(folder / "camchain.yaml").left.fx, 458.654);
  const std::string convert =
      "calibrate convert " + (kitti / "calib.txt").string() + " --output " + in(folder, "kitti.yaml");
  EXPECT_THAT(test::runCartvo(convert).output, HasSubstr("give it by --size"));
  EXPECT_EQ(test::runCartvo(convert + " --size 1226x370").exit_code, 0);
}

TEST(CalibrateConvertCommand, KeepsTheOutputFileOnFailure) {
  const test::TemporaryFolder folder;
  calib::writeRig(folder / "rig.yaml", test::cartRig());
  calib::writeRig(folder / "out.yaml", test::rectifiedRig());
  const test::CommandResult run = test::runCartvo("calibrate convert " + in(folder, "rig.yaml") +
                                                  " --format kalibr --output " + in(folder, "out.yaml"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("Kalibr's radtan model holds the first 4"));
  EXPECT_EQ(calib::readRig(folder / "out.yaml").name, "rectified");
}

TEST(CalibrateConvertCommand, RefusesSwappedCameras) {
  const test::TemporaryFolder folder;
  calib::Rig swapped = test::cartRig();
  swapped.T_right_left = swapped.T_right_left.inverse();
  calib::writeRig(folder / "rig.yaml", swapped);
  const test::CommandResult run = test::runCartvo("calibrate convert " + in(folder, "rig.yaml") +
                                                  " --format opencv --output " + in(folder, "out.yaml"));
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("the cameras are swapped"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.yaml"));
}

}  // namespace
}  // namespace cartvo
