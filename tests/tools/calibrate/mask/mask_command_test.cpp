// Static parts of made-up pictures: a texture that moves behind a bonnet and lettering. `cartvo calibrate
// mask` with the H.264 streams of two cameras that drive past a wall.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/image_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "support/tools/wall_drive.hpp"
#include "tools/calibrate/mask/static_parts.hpp"
#include "tools/simulate/stream/stream_encoder.hpp"

namespace cartvo::calibrate {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kPeriod_ns = 300'000'000;
using test::kBonnet;
using Drive = test::WallDrive;
const cv::Size kSize = test::kWallView;

cv::Mat partsOf(const cv::Rect& place) {
  cv::Mat parts = cv::Mat::zeros(kSize, CV_8UC1);
  parts(place).setTo(255);
  return parts;
}

/// Intersection over union of the static parts with what is static in truth.
double overlap(const StaticParts& found, const cv::Mat& truth) {
  const cv::Mat parts = 255 - found.used;
  return static_cast<double>(cv::countNonZero(parts & truth)) / cv::countNonZero(parts | truth);
}

TEST(StaticParts, AreTheBonnetAndTheLettering) {
  Drive drive;
  drive.showBonnet();
  StaticPartFinder finder;
  for (int i = 0; i < 40; ++i) {
    drive.showLettering("26-11-2026 19:20:" + std::to_string(10 + i));
    drive.setLight(i < 20 ? 1.0 : 0.5);  // into the shade
    finder.add(drive.next(), i * kPeriod_ns);
  }
  const StaticParts found = finder.result();
  EXPECT_EQ(found.pictures, 40U);
  ASSERT_EQ(found.boxes.size(), 2U);
  EXPECT_GT(overlap(found, partsOf(kBonnet) | partsOf({10, 9, 160, 12})), 0.75);
  EXPECT_GT((found.boxes.front() & kBonnet).area(), 0.95 * kBonnet.area());
  EXPECT_NEAR(found.share, 0.22, 0.04);
}

TEST(StaticParts, AreNoneInAnUnobstructedView) {
  Drive drive;
  StaticPartFinder finder;
  for (int i = 0; i < 40; ++i)
    finder.add(drive.next(), i * kPeriod_ns);
  EXPECT_TRUE(finder.result().boxes.empty());
  EXPECT_EQ(finder.result().share, 0.0);
}

TEST(StaticParts, AreNotTheSky) {
  Drive drive;
  StaticPartFinder finder;
  for (int i = 0; i < 40; ++i) {
    cv::Mat picture = drive.next();
    picture.rowRange(0, 80).setTo(200);
    // The horizon follows the cart's pitch.
    picture.rowRange(80, 84 + i % 5 * 2).setTo(200);
    finder.add(picture, i * kPeriod_ns);
  }
  EXPECT_LT(finder.result().share, 0.02);
}

TEST(StaticParts, IgnorePicturesOfAStandstill) {
  Drive drive;
  drive.showBonnet();
  StaticPartFinder finder;
  const cv::Mat standing = drive.next();
  for (int i = 0; i < 200; ++i)
    finder.add(standing, i * kPeriod_ns);
  EXPECT_EQ(finder.pictures(), 1U);
  for (int i = 200; i < 240; ++i)
    finder.add(drive.next(), i * kPeriod_ns);
  EXPECT_GT(overlap(finder.result(), partsOf(kBonnet)), 0.8);
}

TEST(StaticParts, AreFoundAfterABlankBeginning) {
  Drive drive;
  drive.showBonnet();
  StaticPartFinder finder;
  for (int i = 0; i < 10; ++i)
    finder.add(cv::Mat(kSize, CV_8UC1, cv::Scalar(0)), i * kPeriod_ns);
  for (int i = 10; i < 50; ++i)
    finder.add(drive.next(), i * kPeriod_ns);
  EXPECT_EQ(finder.pictures(), 41U);
  EXPECT_GT(overlap(finder.result(), partsOf(kBonnet)), 0.8);
}

TEST(StaticParts, NeedACartThatDrives) {
  Drive drive;
  StaticPartFinder finder;
  const cv::Mat standing = drive.next();
  for (int i = 0; i < 100; ++i)
    finder.add(standing, i * kPeriod_ns);
  EXPECT_THAT(test::messageOf([&] { finder.result(); }),
              HasSubstr("pictures that differ from the one before: 1, needed: 30; drive for a minute"));
}

TEST(StaticParts, AreRefusedAboveHalfOfTheTexture) {
  Drive drive;
  StaticPartFinder finder;
  const cv::Mat still = drive.next();
  for (int i = 0; i < 40; ++i) {
    cv::Mat picture = drive.next();
    // A third of the picture is still, so that the pictures count as different, but the rest has little
    // texture.
    still.rowRange(0, 66).copyTo(picture.rowRange(0, 66));
    for (int x = 0; x < picture.cols; x += 40)
      picture(cv::Rect(x, 66, 25, 134)).setTo(128);
    picture.rowRange(166, 200).setTo(128);
    finder.add(picture, i * kPeriod_ns);
  }
  const std::string message = test::messageOf([&] { finder.result(); });
  EXPECT_THAT(message, HasSubstr("of what has texture keeps its place: did the cart stand?")) << message;
}

TEST(StaticParts, NeedPicturesOfOneSize) {
  Drive drive;
  StaticPartFinder finder;
  finder.add(drive.next(), 0);
  EXPECT_THROW(finder.add(cv::Mat(100, 100, CV_8UC1, cv::Scalar(0)), kPeriod_ns), std::runtime_error);
}

}  // namespace
}  // namespace cartvo::calibrate

namespace cartvo {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

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
