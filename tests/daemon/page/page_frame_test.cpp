// Frames of the status page: pictures and landmarks.
#include "daemon/page/page_frame.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

namespace cartvo::daemon {
namespace {

cv::Mat pictureOf(const cv::Size& size, int grey) {
  return {size, CV_8UC1, cv::Scalar(grey)};
}

cv::Mat decoded(const EncodedPictures& pictures) {
  return cv::imdecode(std::vector<char>(pictures.jpeg.begin(), pictures.jpeg.end()), cv::IMREAD_UNCHANGED);
}

TEST(PageFrame, HasTheLeftPictureAboveTheRight) {
  const EncodedPictures pictures = encodePictures(pictureOf({320, 200}, 40), pictureOf({320, 200}, 200));
  const cv::Mat both = decoded(pictures);
  ASSERT_EQ(both.size(), cv::Size(320, 400));
  EXPECT_NEAR(both.at<std::uint8_t>(100, 160), 40, 3);
  EXPECT_NEAR(both.at<std::uint8_t>(300, 160), 200, 3);
  EXPECT_EQ(pictures.scale, 1);
}

TEST(PageFrame, ReducesLargePictures) {
  for (const auto& [size, scale] :
       {std::pair{cv::Size(961, 301), 2}, {cv::Size(1920, 1080), 2}, {cv::Size(3840, 2160), 4}}) {
    const EncodedPictures pictures = encodePictures(pictureOf(size, 40), pictureOf(size, 200));
    EXPECT_EQ(pictures.scale, scale);
    EXPECT_EQ(decoded(pictures).size(), cv::Size(size.width / scale, size.height / scale * 2));
  }
}

TEST(PageFrame, ShowsTheCameraThatDeliversWithoutTheOther) {
  EXPECT_EQ(encodePictures({}, {}).jpeg, "");
  const EncodedPictures pictures = encodePictures({}, pictureOf({320, 200}, 200));
  const cv::Mat both = decoded(pictures);
  ASSERT_EQ(both.size(), cv::Size(320, 400));
  EXPECT_NEAR(both.at<std::uint8_t>(100, 160), 0, 3);
  EXPECT_NEAR(both.at<std::uint8_t>(300, 160), 200, 3);
  const auto json = nlohmann::json::parse(unpairedJson(pictures));
  EXPECT_EQ(json["width"], 320);
  EXPECT_TRUE(json["sequence"].is_null());
  EXPECT_EQ(decoded(encodePictures(pictureOf({320, 200}, 40), pictureOf({640, 480}, 200))).size(),
            cv::Size(320, 400))
      << "a stream of another size than the rig's";
}

TEST(PageFrame, ListsLandmarksStillRegionsAndTimes) {
  const EncodedPictures pictures{.jpeg = "", .width = 320, .height = 200, .scale = 2};
  pipeline::PairView view;
  view.landmarks = {{.left_x = 10.25F,
                     .left_y = 20.0F,
                     .right_x = NAN,
                     .right_y = NAN,
                     .weight = 0.5F,
                     .age = 3,
                     .inverse_depth = 0.125F},
                    {}};
  view.still_regions = {{8, 16, 24, 32}, {300, 0, 8, 8}};
  view.times.stages[static_cast<std::size_t>(vo::Stage::rectify)] = 0.00125;
  view.times.total = 0.0105;
  const auto json = nlohmann::json::parse(picturesJson(pictures, view, 42));
  EXPECT_EQ(json["still"], nlohmann::json::parse("[[8, 16, 24, 32], [300, 0, 8, 8]]"));
  EXPECT_EQ(json["stages_ms"].size(), vo::kStageCount + 1U);
  EXPECT_EQ(json["stages_ms"]["rectify"], 1.25);
  EXPECT_EQ(json["stages_ms"]["all"], 10.5);
  EXPECT_EQ(json["sequence"], 42);
  EXPECT_EQ(json["scale"], 2);
  ASSERT_EQ(json["landmarks"].size(), 2U);
  EXPECT_EQ(json["landmarks"][0], nlohmann::json::parse("[10.25, 20, null, null, 0.5, 3, 0.125]"));
}

TEST(PageFrame, BeginsWithTheLengthOfItsText) {
  const std::string bytes = frameBytes(std::string(300, 'a'), "jpeg");
  EXPECT_EQ(bytes.substr(0, 4), std::string("\x2c\x01\0\0", 4));
  EXPECT_EQ(bytes.substr(304), "jpeg");
}

}  // namespace
}  // namespace cartvo::daemon
