#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/rtsp_camera.hpp"

namespace cartvo {
namespace {

std::string refusal(const RtspCameraSettings& settings) {
  try {
    const RtspCamera camera(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::string refusalOf(const std::string& url) {
  RtspCameraSettings settings;
  settings.url = url;
  return refusal(settings);
}

TEST(RtspCameraSettings, TakesAnOrdinaryUrl) {
  EXPECT_EQ(refusalOf("rtsp://10.0.0.1:554/Streaming/Channels/101"), "");
}

TEST(RtspCameraSettings, RefusesCredentialsInTheUrlWithoutRepeatingThem) {
  const std::string message = refusalOf("rtsp://admin:hunter2@10.0.0.1/101");
  EXPECT_THAT(message, testing::HasSubstr("must not hold a user or password"));
  EXPECT_THAT(message, testing::HasSubstr("give them as the camera's credentials"));
  EXPECT_THAT(message, testing::Not(testing::HasSubstr("hunter2")));
}

TEST(RtspCameraSettings, RefusesWhatIsNoRtspUrl) {
  EXPECT_THAT(refusalOf("http://10.0.0.1/"), testing::HasSubstr("must begin with rtsp://"));
  EXPECT_THAT(refusalOf("rtsp://10.0.0.1/a b"), testing::HasSubstr("white space"));
  EXPECT_THAT(refusalOf("rtsp:///101"), testing::HasSubstr("must name its host"));
}

TEST(RtspCameraSettings, RefusesTimesThatMakeNoSense) {
  RtspCameraSettings settings;
  settings.url = "rtsp://10.0.0.1/101";
  settings.stall_timeout = std::chrono::milliseconds(0);
  EXPECT_THAT(refusal(settings), testing::HasSubstr("time-outs must be positive"));
}

}  // namespace
}  // namespace cartvo
