// `cartvo calibrate mask` with the H.264 streams of two cameras that drive past a wall.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/image_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "support/tools/wall_drive.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kFrameRate = 4.0;

/// Writes 45 pictures; `stands`: the same picture again and again.
void encode(test::WallDrive drive, bool stands, const std::filesystem::path& file) {
  simulate::StreamEncoder encoder({}, test::kWallView, kFrameRate);
  std::ofstream stream(file, std::ios::binary);
  cv::Mat image = drive.next();
  for (int i = 0; i < 45; ++i) {
    const simulate::EncodedPicture picture = encoder.encode(image);
    stream.write(reinterpret_cast<const char*>(picture.data.data()),
                 static_cast<std::streamsize>(picture.data.size()));
    if (!stands) image = drive.next();
  }
}

class CalibrateMask : public ::testing::Test {
 protected:
  CalibrateMask() {
    test::WallDrive with_bonnet;
    with_bonnet.showBonnet();
    encode(with_bonnet, false, left_);
    encode({}, false, right_);
    calib::Rig rig = test::rectifiedRig();
    rig.left.size = rig.right.size = test::kWallView;
    rig.left.cx = rig.right.cx = 160.0;
    rig.left.cy = rig.right.cy = 100.0;
    rig.right.mask = calib::maskOfPolygons({{{0, 0}, {9, 0}, {9, 9}}}, rig.right.size);
    calib::writeRig(rig_file_, rig);
  }

  test::CommandResult run(const std::filesystem::path& left, const std::string& options) const {
    return test::runCartvo("calibrate mask " + left.string() + " " + right_.string() + " --frame-rate 4 " +
                           options);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path left_ = folder_ / "left.h264", right_ = folder_ / "right.h264";
  std::filesystem::path rig_file_ = folder_ / "rig.yaml";
};

TEST_F(CalibrateMask, WritesPngFilesAndTheirNamesIntoTheRigFile) {
  const test::CommandResult result = run(left_, "--output " + rig_file_.string());
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("% of the picture is static, from 45 pictures"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "rig-mask-left.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "rig-mask-right.png"));
  const calib::Rig rig = calib::readRig(rig_file_);
  ASSERT_FALSE(rig.left.mask.empty());
  EXPECT_EQ(rig.left.mask.file.filename(), "rig-mask-left.png");
  const double masked =
      1.0 - cv::countNonZero(rig.left.mask.used(test::kBonnet)) / static_cast<double>(test::kBonnet.area());
  EXPECT_GT(masked, 0.95);
  EXPECT_NEAR(calib::maskedShare(rig.left.mask), 0.2, 0.05);
  // The measurement replaces the mask that there was.
  EXPECT_TRUE(rig.right.mask.empty());
}

TEST(CalibrateMaskOfAFolder, PrintsPlainLinesOfProgressIntoPipes) {
  const test::TemporaryFolder folder;
  test::WallDrive drive;
  test::writeImageFolder(folder / "drive", 45, kFrameRate,
                         [&](int /*side*/, int /*index*/) { return drive.next(); });
  const test::CommandResult result =
      test::runWithAllProgress("calibrate mask " + (folder / "drive").string());
  EXPECT_EQ(result.exit_code, 0);
  for (const char* side : {"left", "right"}) {
    EXPECT_THAT(result.output, HasSubstr(std::string("] 1/45 pictures, ") + side));
    EXPECT_THAT(result.output,
                ContainsRegex(std::string("45/45 pictures, ") + side + ", [0-9.]+/s, 0:00 left\n"));
  }
  EXPECT_THAT(result.output, Not(HasSubstr("\033")));
}

TEST_F(CalibrateMask, OnlyReportsWithoutOutput) {
  const test::CommandResult result = run(left_, "--json");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto report = nlohmann::json::parse(result.output);
  EXPECT_NEAR(report["left"]["share"], 0.2, 0.05);
  EXPECT_EQ(report["right"]["boxes"].size(), 0U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "rig-mask-left.png"));
}

TEST_F(CalibrateMask, RefusesAStandstillAndKeepsTheRigFile) {
  const std::filesystem::path standing = folder_ / "standing.h264";
  encode({}, true, standing);
  const test::CommandResult result = run(standing, "--output " + rig_file_.string());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("the left camera: pictures that differ from the one before: 1"));
  EXPECT_FALSE(calib::readRig(rig_file_).right.mask.empty());
}

TEST_F(CalibrateMask, RefusesPicturesOfAnotherSizeThanTheRigs) {
  calib::writeRig(rig_file_, test::rectifiedRig());
  const test::CommandResult result = run(left_, "--output " + rig_file_.string());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("the left camera's pictures are 320x200 but the rig was calibrated at "
                                       "640x480"));
}

}  // namespace
}  // namespace cartvo
