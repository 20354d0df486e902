// `cartvo calibrate check` with rendered images of a known rig.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/format/rig_file.hpp"
#include "lab/render/rendered_world.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_data.hpp"
#include "support/tools/run_cartvo.hpp"
#include "tools/calibrate/check/row_check.hpp"

namespace cartvo::calibrate {
namespace {

using ::testing::HasSubstr;

/// A rendered street, one raw pair of it, and its rig.
class CalibrateCheckPair : public ::testing::Test {
 protected:
  void SetUp() override {
    world::WorldSettings settings;
    settings.seconds = 0.1;
    settings.lead_in_seconds = 0.0;
    settings.edge_samples = 0;
    const world::RenderedWorld world(settings);
    cv::Mat left, right;
    world.images(0, left, right);
    cv::imwrite(file("left.png"), left);
    cv::imwrite(file("right.png"), right);
    rig_ = world.rig();
  }

  std::string file(const char* name) const { return (folder_ / name).string(); }

  test::CommandResult check(const calib::Rig& rig, const char* left, const char* right,
                            const std::string& options) {
    calib::writeRig(folder_ / "rig.yaml", rig);
    return test::runCartvo("calibrate check " + file("rig.yaml") + " " + file(left) + " " + file(right) +
                           " " + options);
  }

  test::TemporaryFolder folder_;
  calib::Rig rig_;
};

TEST_F(CalibrateCheckPair, PassesWithTheCorrectRig) {
  const test::CommandResult run = check(rig_, "left.png", "right.png", "--json");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto report = nlohmann::json::parse(run.output);
  EXPECT_TRUE(report["pass"]);
  EXPECT_FALSE(report["swapped"]);
  EXPECT_LT(report["vertical_disparity_px"]["rms"], 0.2);
  EXPECT_LT(report["vertical_disparity_px"]["p95"], 0.4);
  EXPECT_GT(report["matches"], 200);
  EXPECT_THAT(check(rig_, "left.png", "right.png", "").output, HasSubstr("PASS: rows agree within 0.30 px"));
}

TEST_F(CalibrateCheckPair, FailsWithARotatedRightCamera) {
  constexpr double kPitch = 0.002, kFocalLength = 480.0;  // rad, px
  calib::Rig turned = rig_;
  turned.T_right_left.prerotate(Eigen::AngleAxisd(kPitch, Eigen::Vector3d::UnitX()));
  const test::CommandResult run = check(turned, "left.png", "right.png", "--json");
  EXPECT_EQ(run.exit_code, 1) << run.output;
  const auto report = nlohmann::json::parse(run.output);
  EXPECT_FALSE(report["pass"]);
  EXPECT_FALSE(report["swapped"]);
  EXPECT_NEAR(std::abs(report["vertical_disparity_px"]["median"].get<double>()), kPitch * kFocalLength, 0.2);
  EXPECT_LT(report["vertical_disparity_px"]["unexplained_rms"], 0.2);
}

TEST_F(CalibrateCheckPair, PassesWithARemarkIfTheRightCameraIsSlightlyTurned) {
  constexpr double kPitch = 0.001;  // rad
  calib::Rig turned = rig_;
  turned.T_right_left.prerotate(Eigen::AngleAxisd(-kPitch, Eigen::Vector3d::UnitX()));
  const test::CommandResult run = check(turned, "left.png", "right.png", "--json");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  const auto report = nlohmann::json::parse(run.output);
  EXPECT_TRUE(report["slightly_turned"]);
  EXPECT_NEAR(report["turn_deg"]["pitch"].get<double>(), kPitch * 57.3, 0.01)
      << "from the file to the images";
  EXPECT_THAT(check(turned, "left.png", "right.png", "").output,
              HasSubstr("PASS, with a remark: rows differ by 0."));
}

TEST_F(CalibrateCheckPair, DetectsExchangedImages) {
  const test::CommandResult run = check(rig_, "right.png", "left.png", "");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("LEFT and RIGHT are exchanged"));
}

TEST_F(CalibrateCheckPair, RefusesPicturesOfOneCameraAlsoIfEncodedApart) {
  cv::imwrite(file("again.jpg"), cv::imread(file("left.png"), cv::IMREAD_GRAYSCALE));
  for (const char* right : {"left.png", "again.jpg"}) {
    const test::CommandResult run = check(rig_, "left.png", right, "");
    EXPECT_EQ(run.exit_code, 1) << right;
    EXPECT_THAT(run.output, HasSubstr("1 of 1 pairs are the same: they are of one camera")) << right;
  }
}

TEST_F(CalibrateCheckPair, ChecksAFolderWithoutInstants) {
  calib::writeRig(folder_ / "rig.yaml", rig_);
  for (const char* side : {"0", "1"}) {
    const std::filesystem::path images = folder_ / "views" / (std::string("image_") + side);
    std::filesystem::create_directories(images);
    for (const char* name : {"near.png", "far.png"})
      std::filesystem::copy_file(file(*side == '0' ? "left.png" : "right.png"), images / name);
  }
  const test::CommandResult run =
      test::pipeCartvo("calibrate check " + file("rig.yaml") + " " + file("views") + " --json");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_EQ(nlohmann::json::parse(run.output)["pairs"], 2);
}

/// Contradictions of a match 32 px below its row, in the same picture twice.
Contradictions contradictionsIn(const cv::Mat& picture) {
  Contradictions contradictions;
  addContradictions(picture, picture, {{{160.0F, 100.0F}, {150.0F, 132.0F}}}, 0.3, contradictions);
  return contradictions;
}

TEST(Contradictions, AreOfARepeatedPatternOnABoardButNotInAScene) {
  cv::Mat board(240, 320, CV_8UC1), scene(240, 320, CV_8UC1);
  for (int row = 0; row < board.rows; ++row)
    for (int column = 0; column < board.cols; ++column)
      board.at<unsigned char>(row, column) = (row / 16 + column / 16) % 2 == 0 ? 30 : 220;
  cv::RNG(3).fill(scene, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(scene, scene, {}, 1.5);
  // In the scene, the match is the place to which its surroundings were moved.
  scene(cv::Rect(140, 80, 41, 41)).copyTo(scene(cv::Rect(130, 112, 41, 41)));
  cv::Mat right = scene.clone();
  cv::RNG(5).fill(right(cv::Rect(0, 60, 320, 50)), cv::RNG::UNIFORM, 0, 255);
  Contradictions moved;
  addContradictions(scene, right, {{{160.0F, 100.0F}, {150.0F, 132.0F}}}, 0.3, moved);
  EXPECT_EQ(moved.all, 1);
  EXPECT_FALSE(moved.areOfARepeatedPattern());
  EXPECT_TRUE(contradictionsIn(board).areOfARepeatedPattern());
  EXPECT_FALSE(Contradictions().areOfARepeatedPattern());
}

TEST_F(CalibrateCheckPair, ReportsImagesWithoutTexture) {
  cv::imwrite(file("grey.png"), cv::Mat(420, 680, CV_8UC1, cv::Scalar(128)));
  const test::CommandResult run = check(rig_, "grey.png", "grey.png", "");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("only 0 consistent points were found"));
}

TEST(CalibrateCheckCommand, ChecksAFolderOfPairs) {
  CARTVO_NEEDS_DATA(folder, "euroc_still");
  const test::TemporaryFolder temporary;
  const std::string rig = (temporary / "rig.yaml").string(), mav = (folder / "mav0").string();
  ASSERT_EQ(test::runCartvo("calibrate convert " + mav + "/cam0/sensor.yaml " + mav +
                            "/cam1/sensor.yaml --output " + rig)
                .exit_code,
            0);
  const test::CommandResult run =
      test::pipeCartvo("calibrate check " + rig + " " + folder.string() + " --pairs 3 --json");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_EQ(nlohmann::json::parse(run.output)["pairs"], 3);
}

TEST(CalibrateCheckCommand, ReadsKittisCalibrationAndTriesTheExchange) {
  CARTVO_NEEDS_DATA(kitti, "kitti_06");
  CARTVO_NEEDS_DATA(euroc, "euroc_still");
  const test::CommandResult run = test::runCartvo("calibrate check " + (kitti / "calib.txt").string() + " " +
                                                  kitti.string() + " --pairs 3");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("PASS, with a remark"));
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "mav0");
  std::filesystem::create_symlink(std::filesystem::canonical(euroc / "mav0/cam0"), folder / "mav0/cam1");
  std::filesystem::create_symlink(std::filesystem::canonical(euroc / "mav0/cam1"), folder / "mav0/cam0");
  const std::string rig = (folder / "rig.yaml").string(), mav = (euroc / "mav0").string();
  ASSERT_EQ(test::runCartvo("calibrate convert " + mav + "/cam0/sensor.yaml " + mav +
                            "/cam1/sensor.yaml --output " + rig)
                .exit_code,
            0);
  const test::CommandResult exchanged =
      test::runCartvo("calibrate check " + rig + " " + folder.path().string() + " --pairs 3");
  EXPECT_EQ(exchanged.exit_code, 1);
  EXPECT_THAT(exchanged.output, HasSubstr("LEFT and RIGHT are exchanged, or the cameras of the rig file are; "
                                          "exchanged, rows differ by 0."));
}

/// Synthetic matches with a row error, and mismatches among them.
TEST(RowCheck, RejectsMismatchesAndMeasuresTheRowError) {
  calib::Rectification rectification;
  rectification.size = {680, 420};
  rectification.focal_length = 480.0;
  rectification.cx = 340.0;
  rectification.cy = 210.0;
  rectification.baseline = 0.115;
  std::vector<RectifiedMatch> matches;
  for (int i = 0; i < 400; ++i) {
    const float x = static_cast<float>(17 * i % 680), y = static_cast<float>(29 * i % 420);
    const float error = i % 10 == 0 ? 15.0F : 1.2F;
    matches.push_back({{x + 6.0F, y + error}, {x, y}});
  }
  const RowCheck check = checkRows(matches, 1, rectification);
  EXPECT_EQ(check.matches, 360);
  EXPECT_NEAR(check.outliers, 0.1, 1e-9);
  EXPECT_NEAR(check.rms, 1.2, 0.01);
  EXPECT_NEAR(check.median, 1.2, 0.01);
  EXPECT_FALSE(passes(check, 0.3));
  EXPECT_TRUE(passes(check, 1.3));
}

}  // namespace
}  // namespace cartvo::calibrate
