// Conversion of V4L2 buffers, and missing V4L2 cameras. Streaming is tested in a virtual machine with the
// kernel's simulated cameras (vivid): tests/system/boot_vm.sh.
#include "capture/v4l2/v4l2_camera.hpp"

#include <cerrno>
#include <future>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "capture/v4l2/v4l2_picture.hpp"
#include "support/capture/simulated_v4l2.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::capture {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr int kWidth = 6, kHeight = 4;
const cv::Size kSize(kWidth, kHeight);

int greyAt(int x, int y) {
  return 10 * y + x;
}

/// Rows of pixels of `bytes_per_pixel`, the first of which is grey, the others 200; `padding` bytes a row.
std::vector<std::uint8_t> rows(std::size_t bytes_per_pixel, std::size_t padding) {
  std::vector<std::uint8_t> buffer;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      buffer.push_back(static_cast<std::uint8_t>(greyAt(x, y)));
      buffer.insert(buffer.end(), bytes_per_pixel - 1, 200);
    }
    buffer.insert(buffer.end(), padding, 99);
  }
  return buffer;
}

void expectPicture(const cv::Mat& grey) {
  ASSERT_EQ(grey.size(), kSize);
  ASSERT_EQ(grey.type(), CV_8UC1);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      EXPECT_EQ(grey.at<std::uint8_t>(y, x), greyAt(x, y));
}

TEST(V4l2Picture, ConvertsEachFormatWithAnyRowPadding) {
  expectPicture(toGreyImage(PixelFormat::grey, rows(1, 0), kSize, kWidth));
  expectPicture(toGreyImage(PixelFormat::grey, rows(1, 3), kSize, kWidth + 3));
  expectPicture(toGreyImage(PixelFormat::yuyv, rows(2, 4), kSize, 2 * kWidth + 4));
  std::vector<std::uint8_t> with_colours = rows(1, 2);
  with_colours.insert(with_colours.end(), (kWidth + 2) * kHeight / 2, 128);
  expectPicture(toGreyImage(PixelFormat::nv12, with_colours, kSize, kWidth + 2));
}

TEST(V4l2Picture, OwnsItsMemory) {
  std::vector<std::uint8_t> buffer = rows(1, 0);
  const cv::Mat grey = toGreyImage(PixelFormat::grey, buffer, kSize, kWidth);
  std::fill(buffer.begin(), buffer.end(), 255);
  expectPicture(grey);
}

TEST(V4l2Picture, DecodesJpeg) {
  const cv::Mat plain(kSize, CV_8UC1, cv::Scalar(77));
  std::vector<std::uint8_t> jpeg;
  ASSERT_TRUE(cv::imencode(".jpg", plain, jpeg));
  const cv::Mat grey = toGreyImage(PixelFormat::mjpeg, jpeg, kSize, 0);
  ASSERT_EQ(grey.size(), kSize);
  EXPECT_LE(cv::norm(grey, plain, cv::NORM_INF), 2.0);
}

TEST(V4l2Picture, RejectsTruncatedBufferOrOtherSize) {
  std::vector<std::uint8_t> buffer = rows(1, 0);
  buffer.pop_back();
  EXPECT_TRUE(toGreyImage(PixelFormat::grey, buffer, kSize, kWidth).empty());
  EXPECT_TRUE(toGreyImage(PixelFormat::yuyv, rows(1, 0), kSize, 2 * kWidth).empty());
  EXPECT_TRUE(toGreyImage(PixelFormat::grey, rows(1, 0), kSize, kWidth - 1).empty()) << "rows that overlap";
  EXPECT_TRUE(toGreyImage(PixelFormat::nv12, {}, kSize, kWidth).empty());
  EXPECT_TRUE(toGreyImage(PixelFormat::mjpeg, {}, kSize, 0).empty());
  EXPECT_TRUE(toGreyImage(PixelFormat::mjpeg, rows(1, 0), kSize, 0).empty()) << "no JPEG";
  std::vector<std::uint8_t> jpeg;
  ASSERT_TRUE(cv::imencode(".jpg", cv::Mat(8, 8, CV_8UC1, cv::Scalar(77)), jpeg));
  EXPECT_TRUE(toGreyImage(PixelFormat::mjpeg, jpeg, kSize, 0).empty());
}

class AbsentV4l2Camera : public testing::Test {
 protected:
  V4l2CameraSettings settings() const {
    V4l2CameraSettings settings;
    settings.device = folder_.path() / "video0";
    settings.size = kSize;
    settings.retry = milliseconds(10);
    return settings;
  }
  test::TemporaryFolder folder_;
};

TEST_F(AbsentV4l2Camera, IsReportedAsConnecting) {
  V4l2Camera camera(settings());
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(50)), ReadOutcome::timed_out);
  const CameraHealth health = camera.health();
  EXPECT_EQ(health.state, CameraState::connecting);
  EXPECT_EQ(health.frames, 0U);
  EXPECT_THAT(health.last_error, HasSubstr((folder_.path() / "video0").string()));
  EXPECT_THAT(health.last_error, HasSubstr("is it plugged in?"));
}

TEST_F(AbsentV4l2Camera, ReportsFileThatIsNoV4l2Device) {
  V4l2CameraSettings no_camera = settings();
  no_camera.device = "/dev/null";
  V4l2Camera camera(no_camera);
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(50)), ReadOutcome::timed_out);
  EXPECT_THAT(camera.health().last_error, HasSubstr("/dev/null is not a V4L2 device"));
}

TEST_F(AbsentV4l2Camera, EndsAtOnceWhenInterrupted) {
  V4l2CameraSettings slow_retry = settings();
  slow_retry.retry = std::chrono::hours(1);
  V4l2Camera camera(slow_retry);
  Frame frame;
  EXPECT_EQ(camera.read(frame, milliseconds(1)), ReadOutcome::timed_out);
  auto reading = std::async(std::launch::async, [&] { return camera.read(frame, std::chrono::hours(1)); });
  camera.interrupt();
  EXPECT_EQ(reading.get(), ReadOutcome::ended);
  EXPECT_EQ(camera.health().state, CameraState::ended);
  EXPECT_EQ(camera.read(frame, milliseconds(1)), ReadOutcome::ended);
}

TEST_F(AbsentV4l2Camera, RejectsInvalidSettings) {
  V4l2CameraSettings without_size = settings();
  without_size.size = {};
  EXPECT_THROW(V4l2Camera{without_size}, std::invalid_argument);
  V4l2CameraSettings without_timeout = settings();
  without_timeout.stall_timeout = milliseconds(0);
  EXPECT_THROW(V4l2Camera{without_timeout}, std::invalid_argument);
}

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr auto kLong = milliseconds(10'000);  // no wait: the device answers at once

class V4l2OnSimulatedDevice : public testing::Test {
 protected:
  static V4l2CameraSettings settings(const std::filesystem::path& device) {
    V4l2CameraSettings settings;
    settings.device = device;
    settings.size = {6, 4};
    return settings;
  }
  /// Opens the device without a picture: the simulated one reports ENODEV then.
  std::string errorOfOpening() {
    Frame frame;
    EXPECT_EQ(camera_.read(frame, milliseconds(0)), ReadOutcome::timed_out);
    return camera_.health().last_error;
  }
  std::vector<std::uint8_t> grey(std::uint8_t value) const { return std::vector<std::uint8_t>(36, value); }
  static std::vector<std::uint8_t> jpeg() {
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", cv::Mat(4, 6, CV_8UC1, cv::Scalar(77)), bytes);
    return bytes;
  }

  test::TemporaryFolder folder_;
  test::SimulatedV4l2 device_{folder_.path() / "video0"};
  V4l2Camera camera_{settings(device_.device)};
};

TEST_F(V4l2OnSimulatedDevice, EachErrorNumberHasItsRemedy) {
  struct Case {
    unsigned long request;
    int error;
    const char* expected;
  };
  for (const Case& of : {Case{VIDIOC_STREAMON, ENOSPC, "USB controllers"},
                         Case{VIDIOC_REQBUFS, ENOSPC, "USB"}, Case{VIDIOC_STREAMON, EPIPE, "media-ctl"},
                         Case{VIDIOC_STREAMON, ENOLINK, "media-ctl"}, Case{VIDIOC_REQBUFS, ENOMEM, "cma="},
                         Case{VIDIOC_S_FMT, EBUSY, "fuser"}, Case{VIDIOC_STREAMON, EIO, "cable"},
                         Case{VIDIOC_S_FMT, ENODEV, "plugged in"}, Case{VIDIOC_STREAMON, EPROTO, "cable"}}) {
    device_.errors = {{of.request, of.error}};
    V4l2Camera camera(settings(device_.device));
    Frame frame;
    camera.read(frame, milliseconds(0));
    EXPECT_THAT(camera.health().last_error, AllOf(HasSubstr(of.expected), Not(HasSubstr("No space"))));
  }
}

TEST_F(V4l2OnSimulatedDevice, ServesMultiPlanarDrivers) {
  device_.capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  for (const std::uint32_t planes : {1U, 2U}) {
    device_.planes = planes;
    device_.format = planes == 1 ? V4L2_PIX_FMT_NV12 : V4L2_PIX_FMT_NV12M;
    V4l2Camera camera(settings(device_.device));
    Frame frame;
    camera.read(frame, milliseconds(0));
    device_.send(grey(static_cast<std::uint8_t>(50 + planes)), 1, 8);
    ASSERT_EQ(camera.read(frame, kLong), ReadOutcome::frame) << camera.health().last_error;
    EXPECT_EQ(frame.image.at<std::uint8_t>(3, 5), 50 + planes);
  }
}

TEST_F(V4l2OnSimulatedDevice, NamesDevicesThatAreNoCameraAndFormatsThatItOffers) {
  device_.capabilities = V4L2_CAP_VIDEO_M2M_MPLANE | V4L2_CAP_STREAMING;
  EXPECT_THAT(errorOfOpening(), HasSubstr("converts pictures"));
  device_.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  device_.format = V4L2_PIX_FMT_SRGGB10;
  V4l2Camera raw(settings(device_.device));
  Frame frame;
  raw.read(frame, milliseconds(0));
  EXPECT_THAT(raw.health().last_error, AllOf(HasSubstr("RG10"), HasSubstr("ISP")));
}

TEST_F(V4l2OnSimulatedDevice, CutOffJpegsCountAsDamaged) {
  device_.format = V4L2_PIX_FMT_MJPEG;
  Frame frame;
  camera_.read(frame, milliseconds(0));
  const std::vector<std::uint8_t> whole = jpeg();
  device_.send(std::span(whole).first(whole.size() - 6), 1);
  device_.send(whole, 2);
  ASSERT_EQ(camera_.read(frame, kLong), ReadOutcome::frame) << camera_.health().last_error;
  EXPECT_EQ(frame.image.at<std::uint8_t>(0, 0), 77);
  EXPECT_EQ(camera_.health().damaged, 1U);
}

TEST_F(V4l2OnSimulatedDevice, DriverThatDoesNotCountLosesNoPictures) {
  Frame frame;
  camera_.read(frame, milliseconds(0));
  std::vector<std::uint64_t> sequences;
  for (const std::uint32_t sequence : {0U, 0U, 0U}) {
    device_.send(grey(1), sequence);
    ASSERT_EQ(camera_.read(frame, kLong), ReadOutcome::frame) << camera_.health().last_error;
    sequences.push_back(frame.sequence);
  }
  EXPECT_THAT(sequences, testing::ElementsAre(0U, 1U, 2U));
}

}  // namespace

}  // namespace cartvo::capture
