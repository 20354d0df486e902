// Board views from two simulated streams.
#include "tools/calibrate/views/stream_views.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "support/calib/board_scene.hpp"
#include "support/calib/rigs.hpp"
#include "tools/calibrate/views/view_guide.hpp"

namespace cartvo {
namespace {

const calib::BoardSpec& board() {
  static const calib::BoardSpec spec = calib::Chessboard{9, 6, 0.024};
  return spec;
}

/// The image, moved by some pixels: the view of a board that is moved.
cv::Mat moved(const cv::Mat& image, double by) {
  const cv::Matx23d shift(1, 0, by, 0, 1, 0);
  cv::Mat result;
  cv::warpAffine(image, result, shift, image.size(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

constexpr double kBlurStart = 4.0;  // s

/// A camera with 10 Hz. `shift`: position of the board (px) at a time (s). `delay`: time offset of the
/// camera, s. `late_blur`: blur of the images from kBlurStart on, px.
class HeldBoard : public capture::CameraSource {
 public:
  HeldBoard(cv::Mat image, double delay, double (*shift)(double), double late_blur = 0.0)
      : image_(std::move(image)), delay_(delay), shift_(shift), late_blur_(late_blur) {}

  capture::ReadOutcome read(capture::Frame& frame, std::chrono::milliseconds /*timeout*/) override {
    constexpr double kPeriod = 0.1, kEnd = 7.0;
    const double time = kPeriod * count_++ + delay_;
    if (time > kEnd) return capture::ReadOutcome::ended;
    frame.image = moved(image_, shift_(time));
    if (time >= kBlurStart && late_blur_ > 0.0)
      cv::GaussianBlur(frame.image, frame.image, {0, 0}, late_blur_);
    frame.exposure_ns = 1'000'000'000 + static_cast<std::int64_t>(1e9 * time);
    return capture::ReadOutcome::frame;
  }
  capture::CameraHealth health() const override { return {}; }
  void interrupt() noexcept override {}

 private:
  cv::Mat image_;
  double delay_;
  double (*shift_)(double);
  double late_blur_;
  int count_ = 0;
};

cv::Mat seenBy(const calib::CameraModel& camera) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(-0.1, -0.08, 0.4);
  return test::renderBoard(camera, pose, board(), 0.024);
}

StreamedViews viewsOf(double (*shift)(double)) {
  const cv::Mat image = seenBy(test::cartRig().left);
  HeldBoard left(image, 0.0, shift), right(image, 0.04, shift);
  std::size_t views = 0;
  StreamedViews streamed = viewsFromStreams(
      left, right, board(), {.max_seconds = 60.0, .stop_when_complete = false},
      [&views](const StreamProgress& progress) {
        views += progress.has_new_view ? 1 : 0;
        EXPECT_EQ(progress.so_far.views.size(), views);
        EXPECT_THAT(
            progress.next_view_advice,
            ::testing::HasSubstr(views > 0 ? "show the board in the" : "show the board to both cameras"));
        EXPECT_THAT(progress.advice,
                    ::testing::ContainsRegex("hold it still: [01]|taken: move|only the left"));
        EXPECT_LE(progress.left.corners.size(), 54U);
      });
  EXPECT_EQ(views, streamed.views.size());
  return streamed;
}

TEST(StreamViews, TakesAViewEachTimeTheBoardIsStill) {
  // Still until 2 s, then moved for a second, then still.
  const StreamedViews streamed = viewsOf([](double time) { return 30.0 * std::clamp(time - 2.0, 0.0, 1.0); });
  ASSERT_EQ(streamed.views.size(), 2U);
  const auto& [first, second] = std::pair(streamed.views[0].view, streamed.views[1].view);
  ASSERT_EQ(first.left.size(), 54U);
  ASSERT_EQ(first.right.size(), 54U);
  EXPECT_LT((first.left[0].pixel - first.right[0].pixel).norm(), 0.01);
  EXPECT_NEAR(second.left[0].pixel.x() - first.left[0].pixel.x(), 30.0, 0.1);
}

TEST(StreamViews, RejectsABlurredViewWithTheReason) {
  const cv::Mat image = seenBy(test::cartRig().left);
  const auto shift = [](double time) { return time < 2.0 ? 0.0 : time < kBlurStart ? 30.0 : 60.0; };
  HeldBoard left(image, 0.0, shift, 3.0), right(image, 0.04, shift, 3.0);
  std::string rejection;
  std::size_t used = 0;
  viewsFromStreams(left, right, board(), {.max_seconds = 60.0, .stop_when_complete = false},
                   [&](const StreamProgress& progress) {
                     if (progress.has_new_view) rejection = progress.rejection;
                     used = progress.so_far.views.size();
                   });
  EXPECT_EQ(used, 2U);
  EXPECT_THAT(rejection, ::testing::HasSubstr("blurred"));
}

TEST(StreamViews, StopsOnRequest) {
  const cv::Mat image = seenBy(test::cartRig().left);
  const auto held = [](double) { return 0.0; };
  HeldBoard left(image, 0.0, held), right(image, 0.04, held);
  double seconds = 0.0;
  viewsFromStreams(left, right, board(),
                   {.max_seconds = 60.0,
                    .stop_when_complete = false,
                    .is_stop_requested = [&seconds] { return seconds > 2.0; }},
                   [&](const StreamProgress& progress) { seconds = progress.seconds; });
  EXPECT_GT(seconds, 2.0);
  EXPECT_LT(seconds, 3.0);
}

TEST(StreamViews, TakesNoViewOfAMovingBoard) {
  EXPECT_TRUE(viewsOf([](double time) { return 4.0 * time; }).views.empty());
}

TEST(ViewGuide, LineFitsTheTerminal) {
  StreamProgress progress;
  progress.seconds = 12.0;
  progress.advice = "the right camera gives no picture: the camera refused the password";
  EXPECT_EQ(
      guideLine(progress, 1000),
      "12 s, 0 views; corners: left 0, right 0; the right camera gives no picture: the camera refused the "
      "password");
  EXPECT_EQ(guideLine(progress, 90),
            "12 s, 0 views; the right camera gives no picture: the camera refused the password");
  for (const std::size_t columns : {79u, 30u, 2u, 0u})
    EXPECT_LE(guideLine(progress, columns).size(), columns);
}

/// A camera that refuses the password.
class RefusingCamera : public capture::CameraSource {
 public:
  capture::ReadOutcome read(capture::Frame& /*frame*/, std::chrono::milliseconds /*timeout*/) override {
    return capture::ReadOutcome::timed_out;
  }
  capture::CameraHealth health() const override {
    capture::CameraHealth health;
    health.state = capture::CameraState::refused;
    health.last_error = "the camera refused the password";
    return health;
  }
  void interrupt() noexcept override {}
};

TEST(StreamViews, NamesARefusingCameraAtOnceAndInTheEnd) {
  HeldBoard left(seenBy(test::cartRig().left), 0.0, [](double) { return 0.0; });
  RefusingCamera right;
  std::string advice, error;
  try {
    viewsFromStreams(left, right, board(),
                     {.max_seconds = 60.0,
                      .stop_when_complete = false,
                      .is_stop_requested = [&] { return !advice.empty(); }},
                     [&](const StreamProgress& progress) { advice = progress.advice; });
  } catch (const std::runtime_error& refused) {
    error = refused.what();
  }
  EXPECT_EQ(advice, "the right camera gives no picture: the camera refused the password");
  EXPECT_EQ(error, advice);
}

}  // namespace
}  // namespace cartvo
