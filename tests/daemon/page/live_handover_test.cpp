// The handover between the odometry's thread and the page's.
#include "daemon/page/live_handover.hpp"

#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

namespace cartvo::daemon {
namespace {

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
