// The command `cartvo calibrate SOURCE`.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calib/format/kalibr_rig.hpp"
#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string chessboard(const fs::path& data) {
  return "calibrate " + data.string() +
         " --left-images 'left*.jpg' --right-images 'right*.jpg' --board chessboard:9x6:0.025";
}

/// Copies the pairs of a chessboard into image_0 and image_1, to be modified.
void layOut(const fs::path& data, const fs::path& folder, const char* left, const char* right) {
  fs::create_directories(folder / "image_0");
  fs::create_directories(folder / "image_1");
  for (const char* const number : {"01", "02", "03", "04", "05", "06", "07", "08", "09"}) {
    const std::string name = std::string(number) + ".jpg";
    fs::copy_file(data / (left + name), folder / "image_0" / name);
    fs::copy_file(data / (right + name), folder / "image_1" / name);
  }
}

TEST(CalibrateCommand, CalibratesAPairAndReportsItsQuality) {
  CARTVO_NEEDS_DATA(data, "board_opencv");
  const test::TemporaryFolder folder;
  const fs::path output = folder / "rig.yaml", report = folder / "report.html";
  const test::CommandResult run = test::runCartvo(chessboard(data) + " --free-scaling 0.2 --output " +
                                                  output.string() + " --report " + report.string());
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output,
              AllOf(HasSubstr("chosen"), HasSubstr("the calibration passes"), Not(HasSubstr("FAILED")),
                    HasSubstr("next: record a straight drive on level ground")));
  const calib::Rig rig = calib::readRig(output);
  EXPECT_GE(rig.scale_stddev, 1e-3);
  EXPECT_EQ(rig.rectification.free_scaling, 0.2);
  EXPECT_NEAR(rig.left.fx, 534.0, 3.0);  // OpenCV's intrinsics.yml says 534.2
  EXPECT_THAT(run.output, AllOf(HasSubstr("passes its validation, with reservations:"),
                                HasSubstr("only 13 views are used: take at least 3 more"),
                                HasSubstr("depth at 10 m is known to"), Not(HasSubstr("inf"))));
  EXPECT_THAT(test::contentsOf(report),
              AllOf(HasSubstr("class=\"reserved\""), HasSubstr("<svg"), HasSubstr("data:image/png;base64,"),
                    HasSubstr("Rejected views"), Not(HasSubstr("http://127")), HasSubstr("</html>")));
}

TEST(CalibrateCommand, LooksAtItsResultPathsBeforeTheWork) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "file") << "text";
  const std::string command = "calibrate " + (folder / "images").string() + " --board chessboard:9x6:0.025 ";
  for (const std::string& paths :
       {"--output " + (folder / "file/rig.yaml").string(), "--output " + folder.path().string(),
        "--output rig.yaml --report " + (folder / "file/report.html").string(),
        std::string("--output /proc/nope/rig.yaml")}) {
    const test::CommandResult run = test::runCartvo(command + paths);
    EXPECT_EQ(run.exit_code, 1) << paths;
    EXPECT_THAT(run.output, Not(HasSubstr("images"))) << paths << ": the source is looked at later";
  }
}

TEST(CalibrateCommand, IsDeterministicAndKeepsTheMount) {
  CARTVO_NEEDS_DATA(data, "board_opencv");
  const test::TemporaryFolder folder;
  const fs::path output = folder / "rig.yaml";
  const std::string command = chessboard(data) + " --model brown5 --json --output " + output.string();
  const test::CommandResult first = test::pipeCartvo(command);
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const auto json = nlohmann::json::parse(first.output);
  EXPECT_TRUE(json["passed"].get<bool>());
  EXPECT_EQ(json["views"].size(), 13U);
  ASSERT_EQ(json["models"].size(), 1U);
  EXPECT_LE(json["models"][0]["held_out_rms_px"].get<double>(), 0.3);
  // cv::stereoCalibrate as OpenCV's stereo_calib.cpp calls it: docs/architecture.md.
  EXPECT_LE(json["models"][0]["held_out_vertical_disparity_rms_px"].get<double>(), 0.2);
  EXPECT_FALSE(json["reservations"].empty());
  calib::Rig mounted = calib::readRig(output);
  const std::string calibrated = calib::rigText(mounted);
  mounted.T_body_camera.translation() = Eigen::Vector3d(0.9, 0.06, 1.85);
  calib::writeRig(output, mounted);
  const test::CommandResult second = test::pipeCartvo(command);
  EXPECT_EQ(second.output, first.output);
  calib::Rig again = calib::readRig(output);
  EXPECT_EQ(again.T_body_camera.translation(), mounted.T_body_camera.translation());
  again.T_body_camera = calib::forwardLookingMount();
  EXPECT_EQ(calib::rigText(again), calibrated);
}

TEST(CalibrateCommand, AgreesWithThePublishedEurocCalibration) {
  CARTVO_NEEDS_DATA(data, "board_aprilgrid");
  CARTVO_NEEDS_DATA(euroc, "euroc_still");
  const test::TemporaryFolder folder;
  const std::string command =
      "calibrate " + data.string() +
      " --left-images '*_0.jpg' --right-images '*_1.jpg' --board aprilgrid:6x6:0.088:0.3 --output " +
      (folder / "rig.yaml").string();
  // Focal lengths are comparable only within one lens model; the published calibration uses this one.
  const test::CommandResult run = test::pipeCartvo(command + " --model brown4 --json");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto json = nlohmann::json::parse(run.output);
  nlohmann::json found;
  for (const auto& model : json["models"]) {
    if (model["model"] == json["model"]) found = model;
  }
  const auto value = [&](const std::string& name) {
    for (const auto& parameter : found["parameters"]) {
      if (parameter["name"] == name) return parameter["value"].get<double>();
    }
    return 0.0;
  };
  const calib::Rig published =
      calib::readEurocRig(euroc / "mav0/cam0/sensor.yaml", euroc / "mav0/cam1/sensor.yaml");
  EXPECT_NEAR(value("left fx"), published.left.fx, 3e-3 * published.left.fx);
  EXPECT_NEAR(value("left fy"), published.left.fy, 3e-3 * published.left.fy);
  EXPECT_NEAR(value("right fx"), published.right.fx, 3e-3 * published.right.fx);
  EXPECT_NEAR(value("right fy"), published.right.fy, 3e-3 * published.right.fy);
  EXPECT_NEAR(json["baseline_m"].get<double>(), published.baseline(), 3e-4);
  EXPECT_NEAR(json["baseline_m"].get<double>() / published.baseline(), 1.0,
              3.0 * json["scale_deviation"].get<double>());
  EXPECT_LE(found["held_out_rms_px"].get<double>(), 0.3);
  EXPECT_TRUE(json["passed"].get<bool>());
  // The choice among all of Brown's models must succeed too, although some of them fold within the image at
  // first.
  EXPECT_EQ(test::runCartvo(command + " --model brown").exit_code, 0);
}

TEST(CalibrateCommand, ChoosesTheWideModelForAFisheye) {
  CARTVO_NEEDS_DATA(data, "board_fisheye");
  const test::TemporaryFolder folder;
  const fs::path output = folder / "rig.yaml";
  const std::string command =
      "calibrate " + data.string() +
      " --left-images 'board_L/*L.jpg' --right-images 'board_R/*R.jpg' --board chessboard:9x6:0.0345 "
      "--output " +
      output.string();
  const test::CommandResult run = test::runCartvo(command);
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_EQ(calib::readRig(output).left.lens, calib::LensModel::wide);
  EXPECT_THAT(run.output,
              ::testing::ContainsRegex("brown4.*refused: its error on held-out views is [0-9.]+ times that "
                                       "of wide"));
}

TEST(CalibrateCommand, RefusesFaultyInputWithTheReasonAndKeepsTheOutput) {
  CARTVO_NEEDS_DATA(data, "board_opencv");
  const test::TemporaryFolder folder;
  const fs::path output = folder / "rig.yaml";
  const std::string before = calib::rigText(test::cartRig());
  std::ofstream(output) << before;
  const auto expect = [&](const std::string& arguments, const std::string& words) {
    const test::CommandResult run =
        test::runCartvo("calibrate " + arguments + " --output " + output.string());
    EXPECT_EQ(run.exit_code, 1) << run.output;
    EXPECT_THAT(run.output, HasSubstr(words));
    EXPECT_EQ(test::contentsOf(output), before);
  };
  const std::string board = " --board chessboard:9x6:0.025 --model brown2";
  layOut(data, folder / "swapped", "right", "left");
  expect((folder / "swapped").string() + board, "left and right are exchanged");

  layOut(data, folder / "other", "left", "right");
  expect((folder / "other").string() + " --board chessboard:10x7:0.025", "9x6 inner corners");

  expect((folder / "other").string() + " --board chessboard:8x6:0.025 --model brown2",
         "shows a chessboard of 9x6 inner corners, more than --board chessboard:8x6:0.025 has");

  layOut(data, folder / "mixed", "left", "right");
  cv::imwrite((folder / "mixed/image_1/05.jpg").string(), cv::Mat(240, 320, CV_8UC1, cv::Scalar(9)));
  expect((folder / "mixed").string() + board, "05.jpg: is 320x240 but the first image is 640x480");

  layOut(data, folder / "damaged", "left", "right");
  std::ofstream(folder / "damaged/image_0/07.jpg") << "no image";
  expect((folder / "damaged").string() + board, "07.jpg: cannot be decoded as an image");

  layOut(data, folder / "few", "left", "right");
  for (const char* const name : {"01.jpg", "02.jpg", "03.jpg", "04.jpg", "05.jpg"})
    fs::remove(folder / "few/image_1" / name);
  expect((folder / "few").string() + board, "only 4 views show the board to both cameras");

  expect((folder / "nothing").string() + board, "contains no subfolders image_0 (left) and image_1 (right)");

  std::ofstream(folder / "notes.txt") << "was here";
  const test::CommandResult notes = test::runCartvo("calibrate " + (folder / "other").string() + board +
                                                    " --output " + (folder / "notes.txt").string());
  EXPECT_THAT(notes.output, HasSubstr("exists and is not a rig file"));
  EXPECT_EQ(test::contentsOf(folder / "notes.txt"), "was here");
}

TEST(CalibrateCommand, ExitsWith2ForAWrongCommandLine) {
  EXPECT_EQ(test::runCartvo("calibrate").exit_code, 2);
  EXPECT_EQ(test::runCartvo("calibrate . --output rig.yaml").exit_code, 2);
  const test::CommandResult board = test::runCartvo("calibrate . --output rig.yaml --board chessboard:9x6");
  EXPECT_EQ(board.exit_code, 2);
  EXPECT_THAT(board.output, HasSubstr("it has 2 parts"));
  EXPECT_EQ(
      test::runCartvo("calibrate . --output r.yaml --board chessboard:9x6:0.025 --model flat").exit_code, 2);
  EXPECT_EQ(test::runCartvo("calibrate --help").exit_code, 0);
}

}  // namespace
}  // namespace cartvo
