// Static parts of made-up pictures: a texture that moves behind a bonnet and lettering.
#include "tools/calibrate/mask/static_parts.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "support/error_message.hpp"
#include "support/tools/wall_drive.hpp"

namespace cartvo::calibrate {
namespace {

using ::testing::HasSubstr;

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
