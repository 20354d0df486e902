// The last minute and the path of the status page, and samples as JSON.
#include "daemon/page/page_history.hpp"

#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "daemon/page/page_frame.hpp"
#include "daemon/page/status_page.hpp"

namespace cartvo::daemon {
namespace {

using Json = nlohmann::json;

odometry_t messageAt(std::int64_t sequence, double seconds, double x) {
  odometry_t message{};
  message.sequence = sequence;
  message.utime = std::llround(1e6 * seconds);
  message.status = odometry_t::VALID;
  message.position_world_body[0] = x;
  message.orientation_world_body[0] = 1.0;
  return message;
}

PageSample sampleAt(std::int64_t sequence, double seconds, double x) {
  return pageSample(messageAt(sequence, seconds, x), 0.01);
}

double field(const PageSample& sample, const std::string& name) {
  for (std::size_t i = 0; i < kSampleFields.size(); ++i)
    if (name == kSampleFields[i]) return sample.values[i];
  ADD_FAILURE() << name;
  return NAN;
}

TEST(PageSample, TurnsTheCovarianceIntoTheWorld) {
  odometry_t message = messageAt(7, 1.0, 2.0);
  message.orientation_world_body[0] = message.orientation_world_body[3] =
      std::sqrt(0.5);                     // 90 deg to the left
  message.pose_covariance_body[0] = 4.0;  // along the body
  message.pose_covariance_body[7] = 1.0;
  message.twist_covariance_body[35] = 0.25;
  message.arrival_utime = 1'000'000;
  message.publication_utime = 1'012'500;
  message.quality = 60;
  message.velocity_bound[0] = 0.12;
  message.angular_rate_bound[2] = 0.03;
  message.motion_bound[1] = 0.05;
  const PageSample sample = pageSample(message, 0.008);
  EXPECT_NEAR(field(sample, "yaw"), std::acos(0.0), 1e-12);
  EXPECT_NEAR(field(sample, "xx"), 1.0, 1e-12);
  EXPECT_NEAR(field(sample, "yy"), 4.0, 1e-12);
  EXPECT_EQ(field(sample, "stddev_yaw_rate"), 0.5);
  EXPECT_EQ(field(sample, "latency_ms"), 12.5);
  EXPECT_EQ(field(sample, "process_ms"), 8.0);
  EXPECT_EQ(field(sample, "quality"), 60.0);
  EXPECT_EQ(field(sample, "bound_speed"), 0.12);
  EXPECT_EQ(field(sample, "bound_yaw_rate"), 0.03);
  EXPECT_EQ(field(sample, "bound_motion"), 0.05) << "the largest of the three axes";
}

TEST(PageSample, NamesEachNumberOnceAndWritesUnknownOnesAsNull) {
  EXPECT_EQ(std::set<std::string>(kSampleFields.begin(), kSampleFields.end()).size(), kSampleFields.size());
  odometry_t message = messageAt(3, 1'700'000'000.123456, 0.0);
  message.velocity_body[0] = std::numeric_limits<double>::quiet_NaN();
  std::string text;
  appendJson(pageSample(message, std::numeric_limits<double>::infinity()), text);
  const Json json = Json::parse(text);
  ASSERT_EQ(json.size(), kSampleFields.size());
  EXPECT_EQ(json[0], 3);
  EXPECT_EQ(json[1], 1'700'000'000'123'456);
  EXPECT_TRUE(json[12].is_null());
  EXPECT_TRUE(json[21].is_null());
}

TEST(PageHistory, KeepsOneMinute) {
  PageHistory history;
  for (int i = 0; i <= 700; ++i)
    history.add(sampleAt(i, 0.1 * i, 0.0));
  EXPECT_EQ(history.size(), 601U);
  EXPECT_EQ(Json::parse(history.json())["samples"][0][0], 100);
  EXPECT_EQ(Json::parse(history.newestJson(3)).size(), 3U);
  EXPECT_EQ(Json::parse(history.newestJson(3))[2][0], 700);
}

TEST(PageHistory, IsBoundedAtHighRatesAndOnLongDrives) {
  PageHistory history;
  for (int i = 0; i < 30'000; ++i)
    history.add(sampleAt(i, 0.001 * i, i));
  EXPECT_EQ(history.size(), PageHistory::kMaxSamples);
  EXPECT_LE(history.pathSize(), PageHistory::kMaxPathPoints);
  EXPECT_GT(history.pathSize(), PageHistory::kMaxPathPoints / 4);
}

TEST(PageHistory, BeginsAnewWhenTheClockIsSetBack) {
  PageHistory history;
  history.add(sampleAt(0, 1000.0, 0.0));
  history.add(sampleAt(1, 100.0, 0.0));
  EXPECT_EQ(history.size(), 1U);
}

TEST(PageHistory, LeavesInvalidPairsOutOfThePath) {
  PageHistory history;
  history.add(sampleAt(0, 1.0, 0.0));
  odometry_t invalid = messageAt(1, 1.1, 5.0);
  invalid.status = odometry_t::INVALID;
  history.add(pageSample(invalid, 0.01));
  EXPECT_EQ(history.pathSize(), 1U);
  EXPECT_EQ(history.size(), 2U);
}

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

PageSample sampleOf(std::int64_t sequence) {
  PageSample sample;
  sample.values[0] = static_cast<double>(sequence);
  return sample;
}

TEST(LiveHandover, WantsNoPicturesWithoutAViewer) {
  LiveHandover handover;
  EXPECT_EQ(handover.nextView(), nullptr);
  handover.addPair(sampleOf(1));
  EXPECT_EQ(handover.takeSnapshot(), nullptr);
  EXPECT_EQ(handover.nextSample()->sequence(), 1);
  EXPECT_FALSE(handover.nextSample());
}

TEST(LiveHandover, HandsOverOnePairInATenthOfASecond) {
  LiveHandover handover;
  handover.noteViewer();
  const auto begin = LiveHandover::Clock::now();
  pipeline::PairView* view = handover.nextViewAt(begin);
  ASSERT_NE(view, nullptr);
  view->left = cv::Mat(2, 2, CV_8UC1, cv::Scalar(9));
  handover.addPair(sampleOf(5));
  EXPECT_EQ(handover.nextViewAt(begin + std::chrono::milliseconds(90)), nullptr);
  handover.addPair(sampleOf(6));
  std::unique_ptr<PageSnapshot> snapshot = handover.takeSnapshot();
  ASSERT_NE(snapshot, nullptr);
  EXPECT_EQ(snapshot->sequence, 5);
  EXPECT_EQ(snapshot->view.left.at<std::uint8_t>(1, 1), 9);
  EXPECT_EQ(handover.takeSnapshot(), nullptr);
  EXPECT_NE(handover.nextViewAt(begin + std::chrono::milliseconds(110)), nullptr);
  EXPECT_EQ(handover.nextViewAt(begin + std::chrono::milliseconds(190)), nullptr);
  EXPECT_NE(handover.nextViewAt(begin + std::chrono::milliseconds(200)), nullptr)
      << "ten a second on average";
  EXPECT_EQ(handover.nextViewAt(begin + std::chrono::seconds(10)), nullptr) << "the viewer has gone";
}

TEST(LiveHandover, HandsOverEachCamerasPicturesWhetherPairedOrNot) {
  LiveHandover handover;
  const auto begin = LiveHandover::Clock::now();
  constexpr auto kLeft = capture::CameraSide::left;
  EXPECT_TRUE(std::isnan(handover.takeCamera(kLeft, begin).age));
  handover.addFrame(kLeft, cv::Mat(2, 2, CV_8UC1, cv::Scalar(9)), begin);
  const CameraView unwatched = handover.takeCamera(kLeft, begin + std::chrono::milliseconds(50));
  EXPECT_TRUE(unwatched.picture.empty()) << "nothing is copied without a viewer";
  EXPECT_NEAR(unwatched.age, 0.05, 1e-9);
  handover.noteViewer();
  handover.addFrame(kLeft, cv::Mat(2, 2, CV_8UC1, cv::Scalar(9)), begin);
  handover.addFrame(kLeft, cv::Mat(2, 2, CV_8UC1, cv::Scalar(8)), begin + std::chrono::milliseconds(100));
  const CameraView watched = handover.takeCamera(kLeft, begin + std::chrono::milliseconds(150));
  ASSERT_FALSE(watched.picture.empty());
  EXPECT_EQ(watched.picture.at<std::uint8_t>(1, 1), 9) << "five a second";
  EXPECT_NEAR(watched.age, 0.05, 1e-9);
  EXPECT_TRUE(std::isnan(handover.takeCamera(capture::CameraSide::right, begin).age));
}

TEST(LiveHandover, APairThatWasNotWantedIsNotHandedOver) {
  LiveHandover handover;
  handover.noteViewer();
  ASSERT_NE(handover.nextView(), nullptr);
  handover.addMissedPair(sampleOf(1));  // the pair failed; the next one has not asked
  EXPECT_EQ(handover.takeSnapshot(), nullptr);
}

TEST(LiveHandover, LosesSamplesRatherThanWaiting) {
  LiveHandover handover;
  for (int i = 0; i < 5000; ++i)
    handover.addPair(sampleOf(i));
  int count = 0;
  while (handover.nextSample())
    ++count;
  EXPECT_GE(count, 1000);
  EXPECT_LT(count, 5000);
}

TEST(LiveHandover, KeepsTheNewestHealthOnly) {
  LiveHandover handover;
  for (int pairs : {1, 2}) {
    PageHealth health;
    health.health.pairs = pairs;
    handover.setHealth(std::move(health));
  }
  EXPECT_EQ(handover.takeHealth()->health.pairs, 2);
  EXPECT_EQ(handover.takeHealth(), nullptr);
}

}  // namespace

}  // namespace cartvo::daemon
