// Values of a camera's settings. Comparison of two cameras' settings with what odometry needs.
#include "tools/camera/settings_check.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/camera/camera_fixture.hpp"
#include "tools/camera/camera_settings.hpp"

namespace cartvo {
namespace {

using test::IsapiServer;

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

Finding findingOf(const std::vector<Finding>& findings, const std::string& name) {
  return *std::find_if(findings.begin(), findings.end(),
                       [&](const Finding& finding) { return finding.setting.name == name; });
}

std::vector<Finding> checkOne(const test::IsapiDocuments& documents, const OdometryNeeds& needs = {}) {
  const IsapiServer server({}, documents);
  const CameraDocuments camera = test::readSimulatedCamera(server);
  return checkCameras({&camera, nullptr}, needs)[0];
}

TEST(SettingsCheck, FindsWhatAFactorySetsWrong) {
  const std::vector<Finding> findings = checkOne(test::factoryDocuments());
  for (const char* name :
       {"stabilisation", "lens-correction", "wdr", "dehaze", "slow-shutter", "shutter", "day-night",
        "osd-name", "osd-time", "osd-text", "smart-codec", "svc", "key-frame-interval", "bit-rate-mode",
        "bit-rate", "audio", "time-mode", "time-interval"}) {
    const Finding finding = findingOf(findings, name);
    EXPECT_EQ(finding.verdict, Verdict::wrong) << name;
    EXPECT_GT(finding.setting.reason.size(), 10U) << name;
  }
  for (const char* name : {"codec", "frame-rate", "flip", "blc"})
    EXPECT_EQ(findingOf(findings, name).verdict, Verdict::good) << name;
  EXPECT_EQ(findingOf(findings, "profile").verdict, Verdict::not_reported) << "it does not count with H.265";
}

TEST(SettingsCheck, ComparesWithTheConfiguredRateAndTheRig) {
  OdometryNeeds needs;
  needs.frame_rate = 18.0;
  needs.width = 680;
  needs.height = 720;
  const std::vector<Finding> findings = checkOne(test::factoryDocuments(), needs);
  EXPECT_EQ(findingOf(findings, "frame-rate").verdict, Verdict::wrong);
  EXPECT_EQ(findingOf(findings, "width").verdict, Verdict::wrong);
  EXPECT_EQ(findingOf(findings, "height").verdict, Verdict::good);
}

TEST(SettingsCheck, TellsMissingFromUnneeded) {
  test::IsapiDocuments documents = test::oldFirmwareDocuments();
  documents.erase("/ISAPI/System/time");
  const std::vector<Finding> findings = checkOne(documents);
  EXPECT_EQ(findingOf(findings, "stabilisation").verdict, Verdict::not_reported);
  EXPECT_EQ(findingOf(findings, "time-mode").verdict, Verdict::unknown);
}

TEST(SettingsCheck, FindsWhatIsUnlike) {
  const IsapiServer left;
  const IsapiServer right(
      {}, test::withSerialNumber(test::replaced(test::factoryDocuments(), ">50hz<", ">60hz<"), "other"));
  const CameraDocuments documents[]{test::readSimulatedCamera(left), test::readSimulatedCamera(right)};
  const CameraPair pair{&documents[0], &documents[1]};
  const auto findings = checkCameras(pair, {});
  EXPECT_EQ(findingOf(findings[0], "mains-frequency").verdict, Verdict::unlike);
  EXPECT_EQ(findingOf(findings[1], "mains-frequency").verdict, Verdict::unlike);
  EXPECT_EQ(findingOf(findings[1], "codec").verdict, Verdict::good);
  EXPECT_FALSE(areSameCamera(pair));
  EXPECT_THAT(compareCameras(pair), testing::IsEmpty());
}

TEST(SettingsCheck, TakesTwoAddressesOfThisComputerForOneTimeServer) {
  const auto camera_of = [](const std::string& server) {
    const IsapiServer camera({}, test::replaced(test::factoryDocuments(), "time.windows.com", server));
    return test::readSimulatedCamera(camera);
  };
  const CameraDocuments left = camera_of("192.168.101.1"), right = camera_of("192.168.102.1");
  OdometryNeeds needs;
  needs.host_addresses = {"192.168.101.1"};
  EXPECT_EQ(findingOf(checkCameras({&left, &right}, needs)[0], "time-server").verdict, Verdict::unlike);
  needs.host_addresses.emplace_back("192.168.102.1");
  EXPECT_EQ(findingOf(checkCameras({&left, &right}, needs)[0], "time-server").verdict, Verdict::good);
}

TEST(SettingsCheck, FindsOneCameraAtTwoAddresses) {
  const IsapiServer server;
  const CameraDocuments documents[]{test::readSimulatedCamera(server), test::readSimulatedCamera(server)};
  const CameraPair pair{&documents[0], &documents[1]};
  EXPECT_TRUE(areSameCamera(pair));
  EXPECT_THAT(compareCameras(pair), testing::ElementsAre(testing::HasSubstr("one camera")));
}

}  // namespace
}  // namespace cartvo
