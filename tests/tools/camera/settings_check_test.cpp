// Comparison of two cameras' settings with what odometry needs.
#include "tools/camera/settings_check.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/camera/camera_fixture.hpp"

namespace cartvo {
namespace {

using test::IsapiServer;

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
