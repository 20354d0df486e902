// Validation of an RTSP camera's settings.

#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/rtsp/rtsp_camera.hpp"

namespace cartvo::capture {
namespace {

std::string errorOf(const RtspCameraSettings& settings) {
  try {
    const RtspCamera camera(settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

std::string errorOfUrl(const std::string& url) {
  RtspCameraSettings settings;
  settings.url = url;
  return errorOf(settings);
}

TEST(RtspCameraSettings, AcceptsOrdinaryUrl) {
  EXPECT_EQ(errorOfUrl("rtsp://10.0.0.1:554/Streaming/Channels/101"), "");
}

TEST(RtspCameraSettings, RejectsCredentialsInUrlWithoutRepeatingThem) {
  const std::string message = errorOfUrl("rtsp://admin:hunter2@10.0.0.1/101");
  EXPECT_THAT(message, testing::HasSubstr("must not contain a user or password"));
  EXPECT_THAT(message, testing::HasSubstr("give them as the camera's credentials"));
  EXPECT_THAT(message, testing::Not(testing::HasSubstr("hunter2")));
}

TEST(RtspCameraSettings, RejectsInvalidUrl) {
  EXPECT_THAT(errorOfUrl("http://10.0.0.1/"), testing::HasSubstr("must begin with rtsp://"));
  EXPECT_THAT(errorOfUrl("rtsp://10.0.0.1/a b"), testing::HasSubstr("white space"));
  EXPECT_THAT(errorOfUrl("rtsp:///101"), testing::HasSubstr("must contain a host"));
}

TEST(RtspCameraSettings, RejectsTimeoutOfZero) {
  RtspCameraSettings settings;
  settings.url = "rtsp://10.0.0.1/101";
  settings.stall_timeout = std::chrono::milliseconds(0);
  EXPECT_THAT(errorOf(settings), testing::HasSubstr("time-outs must be positive"));
}

}  // namespace
}  // namespace cartvo::capture
