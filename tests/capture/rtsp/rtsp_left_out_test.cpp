// Health of a camera names each kind of data that is left out, over real sockets on loopback.

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "capture/rtsp/rtsp_camera.hpp"
#include "tests/support/capture/encoded_sequence.hpp"
#include "tests/support/capture/live_camera.hpp"
#include "tests/support/capture/scripted_camera.hpp"

namespace cartvo::capture {
namespace {

using test::CameraScript;
using test::ScriptedCamera;

CameraScript faultlessScript() {
  CameraScript script;
  script.pictures = test::encodeSequence(VideoCodec::h264, {240, 180}, 40, 10, "");
  return script;
}

/// Reads until the camera's advice contains the text.
void expectAdvice(const CameraScript& with_fault, const std::string& text) {
  ScriptedCamera server(with_fault);
  RtspCameraSettings settings = test::settingsFor(server.port());
  settings.credentials = {};
  RtspCamera camera(settings);
  EXPECT_TRUE(test::readUntil(camera, [&](ReadOutcome, const Frame&) {
    return camera.health().advice.find(text) != std::string::npos;
  })) << camera.health().advice;
  EXPECT_EQ(camera.health().reconnections, 0U);
}

TEST(RtspLeftOut, NamesReportsOfAClockThatIsNotSet) {
  CameraScript unset = faultlessScript();
  unset.clock_error = [](double) { return -2.0e9; };
  expectAdvice(unset, "sender reports that state a time before 1970: set its clock");
}

TEST(RtspLeftOut, NamesPicturesWhoseRtpTimeIsAnother) {
  CameraScript stray = faultlessScript();
  stray.frame_rate = 100.0;
  auto pictures = std::make_shared<int>(0);
  stray.link = [pictures](const CameraScript::Packet& packet, const CameraScript::Send& send) {
    CameraScript::Packet changed = packet;
    if (*pictures % 3 == 2) changed[4] ^= 0x40;  // of the RTP time
    if ((packet[1] & 0x80) != 0) ++*pictures;
    send(changed);
  };
  expectAdvice(stray, "pictures whose RTP time does not follow from that of the others (100 or more)");
}

}  // namespace
}  // namespace cartvo::capture
