// V4l2Camera on a simulated device: multi-planar drivers, error numbers, incomplete pictures.
#include <cerrno>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "capture/v4l2/v4l2_camera.hpp"
#include "support/capture/simulated_v4l2.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::capture {
namespace {

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
