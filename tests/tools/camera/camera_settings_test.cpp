// Values of a camera's settings.
#include "tools/camera/camera_settings.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/camera/camera_fixture.hpp"

namespace cartvo {
namespace {

Setting settingOf(const std::string& name, const OdometryNeeds& needs = {}, double frame_rate = 18.0) {
  const std::vector<Setting> all = cameraSettings(needs, frame_rate);
  return *std::find_if(all.begin(), all.end(), [&](const Setting& setting) { return setting.name == name; });
}

TEST(CameraChannels, FollowTheRtspUrl) {
  EXPECT_EQ(channelsOf("rtsp://h:554/Streaming/Channels/102").stream, 102);
  EXPECT_EQ(channelsOf("rtsp://h/streaming/channels/201?transport=1").video, 2);
  EXPECT_EQ(channelsOf("rtsp://h/h264/ch1/sub/av_stream").stream, 102);
  EXPECT_EQ(channelsOf("rtsp://h/live").stream, 101);
  EXPECT_EQ(channelsOf("rtsp://h/Streaming/Channels/99999999999").stream, 101);
}

TEST(CameraSettings, ReadOldAndNewFirmwareAlike) {
  const test::IsapiServer new_server, old_server({}, test::oldFirmwareDocuments());
  const CameraDocuments with_new = test::readSimulatedCamera(new_server);
  const CameraDocuments with_old = test::readSimulatedCamera(old_server);
  EXPECT_EQ(with_old.identity.model, "DS-2CD2143G2-I");
  for (const char* name : {"shutter", "frame-rate", "time-server", "osd-text", "codec", "audio"})
    EXPECT_EQ(valueOf(settingOf(name), with_old), valueOf(settingOf(name), with_new)) << name;
  EXPECT_EQ(valueOf(settingOf("wdr"), with_new), "open");
  EXPECT_EQ(valueOf(settingOf("wdr"), with_old), "true");
  EXPECT_EQ(valueOf(settingOf("stabilisation"), with_old), std::nullopt);
  EXPECT_EQ(bestValue(settingOf("wdr"), {&with_new}), "close");
  EXPECT_EQ(bestValue(settingOf("wdr"), {&with_old}), "false");
}

TEST(CameraSettings, JudgeExposures) {
  const Setting shutter = settingOf("shutter");
  EXPECT_TRUE(fits(shutter, "1/250"));
  EXPECT_TRUE(fits(shutter, "1/1000"));
  EXPECT_TRUE(fits(shutter, "0.001"));
  for (const char* value : {"1/249", "1/25", "", "1/0", "-1/500", "auto", "0"})
    EXPECT_FALSE(fits(shutter, value)) << value;
  EXPECT_EQ(wantedText(shutter), "at most 1/250");
}

TEST(CameraSettings, ShowTheFrameRateInHertz) {
  const test::IsapiServer server;
  CameraDocuments camera = test::readSimulatedCamera(server);
  OdometryNeeds needs;
  needs.frame_rate = 18.0;
  const Setting rate = settingOf("frame-rate", needs);
  EXPECT_EQ(valueOf(rate, camera), "25");
  EXPECT_FALSE(fits(rate, "25"));
  EXPECT_THAT(offeredValues(rate, camera), testing::Contains("18"));
  EXPECT_EQ(offerProblem(rate, camera, "18"), "");
  EXPECT_THAT(offerProblem(rate, camera, "17"), testing::HasSubstr("the camera offers 6, 12, 15, 18"));
  EXPECT_TRUE(setValue(rate, *camera.of(Document::stream), "18"));
  EXPECT_EQ(camera.of(Document::stream)->text("Video/maxFrameRate"), "1800");
}

TEST(CameraSettings, ChooseTheNearestExposureThatBothOffer) {
  const test::IsapiServer left;
  const test::IsapiServer right({}, test::replaced(test::factoryDocuments(), "1/500,", ""));
  const CameraDocuments documents[]{test::readSimulatedCamera(left), test::readSimulatedCamera(right)};
  EXPECT_EQ(bestValue(settingOf("shutter"), {&documents[0]}), "1/500");
  EXPECT_THAT(bestValue(settingOf("shutter"), {&documents[0], &documents[1]}),
              testing::AnyOf("1/250", "1/1000"));
}

TEST(CameraSettings, LeaveOutOffersTooLongToBeShown) {
  const std::string long_exposure = "0.002" + std::string(80, '0');
  const test::IsapiServer server({}, test::replaced(test::factoryDocuments(), "1/500,", long_exposure + ","));
  const CameraDocuments camera = test::readSimulatedCamera(server);
  EXPECT_THAT(offeredValues(settingOf("shutter"), camera), testing::Not(testing::Contains(long_exposure)));
  EXPECT_THAT(bestValue(settingOf("shutter"), {&camera}), testing::AnyOf("1/250", "1/1000"));
}

TEST(CameraSettings, SetATimeServerByAddressAndByName) {
  const test::IsapiServer server;
  CameraDocuments camera = test::readSimulatedCamera(server);
  const Setting setting = settingOf("time-server");
  capture::XmlDocument& document = *camera.of(Document::time_servers);
  EXPECT_TRUE(setValue(setting, document, "192.168.1.10"));
  EXPECT_EQ(document.text("NTPServer/addressingFormatType"), "ipaddress");
  EXPECT_EQ(valueOf(setting, camera), "192.168.1.10");
  for (const char* name : {"cart.local", "1.2.3"}) {
    EXPECT_TRUE(setValue(setting, document, name));
    EXPECT_EQ(document.text("NTPServer/addressingFormatType"), "hostname");
    EXPECT_EQ(valueOf(setting, camera), name);
  }
}

}  // namespace
}  // namespace cartvo
