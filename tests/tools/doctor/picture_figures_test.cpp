// The figures of the report hold the pictures themselves, scaled down.
#include "tools/doctor/picture_figures.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "common/base64.hpp"
#include "support/calib/rigs.hpp"

namespace cartvo::doctor {
namespace {

using ::testing::HasSubstr;

/// The embedded pictures, decoded.
std::vector<cv::Mat> picturesIn(const std::string& html) {
  const std::string start = "src=\"data:image/jpeg;base64,";
  std::vector<cv::Mat> pictures;
  for (std::size_t at = html.find(start); at != std::string::npos; at = html.find(start, at)) {
    at += start.size();
    const auto jpeg = decodeBase64(html.substr(at, html.find('"', at) - at));
    if (!jpeg) {
      ADD_FAILURE() << "no base64";
      return pictures;
    }
    pictures.push_back(
        cv::imdecode(std::vector<unsigned char>(jpeg->begin(), jpeg->end()), cv::IMREAD_GRAYSCALE));
  }
  return pictures;
}

PicturePair plainPair(const cv::Size& size) {
  return {cv::Mat(size, CV_8UC1, cv::Scalar(60)), cv::Mat(size, CV_8UC1, cv::Scalar(200)), 0, 0};
}

TEST(PictureFigures, AreBothPicturesAndBothRectifiedAtHalfStrength) {
  const calib::Rig rig = test::cartRig();
  const std::string html = pictureFigures(plainPair(rig.left.size), &rig);
  const std::vector<cv::Mat> pictures = picturesIn(html);
  ASSERT_EQ(pictures.size(), 3U);
  for (const cv::Mat& picture : pictures)
    EXPECT_EQ(picture.size(), rig.left.size);
  const cv::Point between_lines(340, 26);
  EXPECT_NEAR(pictures[0].at<unsigned char>(between_lines), 60, 2);
  EXPECT_NEAR(pictures[1].at<unsigned char>(between_lines), 200, 2);
  EXPECT_NEAR(pictures[2].at<unsigned char>(between_lines), 130, 2);
  EXPECT_THAT(html, HasSubstr("alt=\"picture of the left camera, 680x420 px, not rectified\""));
  EXPECT_THAT(html, HasSubstr("alt=\"picture of the right camera, "));
  EXPECT_THAT(html, HasSubstr("alt=\"both pictures, rectified with the rig file, "));
}

TEST(PictureFigures, AreScaledDown) {
  const std::vector<cv::Mat> pictures = picturesIn(pictureFigures(plainPair({1920, 1080}), nullptr));
  ASSERT_EQ(pictures.size(), 2U);
  EXPECT_EQ(pictures[0].size(), cv::Size(960, 540));
}

TEST(PictureFigures, LeaveOutTheOverlayOfARigForOtherPictures) {
  const calib::Rig rig = test::cartRig();
  EXPECT_EQ(picturesIn(pictureFigures(plainPair({640, 480}), &rig)).size(), 2U);
}

}  // namespace
}  // namespace cartvo::doctor
