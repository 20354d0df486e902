// Changing of settings on cameras with several firmwares.
#include <algorithm>
#include <array>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/camera/camera_fixture.hpp"
#include "support/error_message.hpp"
#include "tools/camera/settings_change.hpp"

namespace cartvo {
namespace {

using test::CameraHabits;
using test::IsapiServer;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr const char* kImage = "/ISAPI/Image/channels/1";

Selection everything() {
  Selection selection;
  selection.all = true;
  selection.settings["time-server"] = "192.168.1.10";
  return selection;
}

ChangePlan planFor(const IsapiServer& server, const Selection& selection) {
  const CameraDocuments camera = test::readSimulatedCamera(server);
  return planChanges({&camera, nullptr}, {}, selection);
}

ApplyResult applyTo(const IsapiServer& server, const Selection& selection) {
  const std::vector<Change> changes = planFor(server, selection).changes[0];
  capture::IsapiClient client(test::isapiSettings(server));
  return applyChanges(client, {}, changes);
}

/// Names of settings that are still wrong.
std::vector<std::string> wrongSettings(const IsapiServer& server) {
  const CameraDocuments camera = test::readSimulatedCamera(server);
  std::vector<std::string> names;
  const auto findings = checkCameras({&camera, nullptr}, {});
  for (const Finding& finding : findings[0])
    if (!finding.isGood()) names.push_back(finding.setting.name);
  return names;
}

struct Firmware {
  const char* name;
  CameraHabits habits;
  test::IsapiDocuments documents = test::factoryDocuments();
};

std::vector<Firmware> firmwares() {
  CameraHabits whole, parts, ignoring, lazy;
  whole.takes_parts = false;
  parts.takes_whole_documents = false;
  ignoring.ignores_image_changes = true;
  lazy.nonce_uses = 1;
  return {{"whole documents only", whole},
          {"sub-resources only", parts},
          {"accepts the whole image without effect", ignoring},
          {"one request for each nonce", lazy},
          {"other namespace", {}, test::factoryDocuments("xmlns=\"http://www.std-cgi.com/ver20/XMLSchema\"")},
          {"no namespace", {}, test::factoryDocuments("version=\"1.0\"")},
          {"old: prefixes, blanks, elements missing", {}, test::oldFirmwareDocuments()}};
}

TEST(SettingsApply, LeadsEachFirmwareToWhatOdometryNeeds) {
  for (const Firmware& firmware : firmwares()) {
    const IsapiServer server(firmware.habits, firmware.documents);
    const ApplyResult result = applyTo(server, everything());
    for (const ChangeResult& one : result.results)
      EXPECT_TRUE(one.is_taken) << firmware.name << ": " << one.change.setting.name << ": " << one.problem;
    EXPECT_FALSE(result.needs_reboot);
    EXPECT_THAT(wrongSettings(server), IsEmpty()) << firmware.name;
    EXPECT_EQ(server.mostAtOnce(), 1);
  }
}

TEST(SettingsApply, KeepsWhatItDoesNotKnow) {
  const IsapiServer server;
  applyTo(server, everything());
  EXPECT_THAT(server.document(kImage),
              HasSubstr("<vendorExtension><secretSauce level=\"7\">keep me</secretSauce></vendorExtension>"));
  EXPECT_THAT(server.document(kImage), HasSubstr("<brightnessLevel>50</brightnessLevel>"));
  EXPECT_THAT(server.document(kImage), HasSubstr("<powerLineFrequencyMode>50hz</powerLineFrequencyMode>"));
}

TEST(SettingsApply, ChangesOnlyWhatIsNamed) {
  const IsapiServer server;
  const std::string before = server.document(kImage);
  Selection selection;
  selection.settings["wdr"] = std::nullopt;
  const ApplyResult result = applyTo(server, selection);
  ASSERT_EQ(result.results.size(), 1U);
  EXPECT_EQ(result.results[0].change.to, "close");
  const std::string image = server.document(kImage);
  EXPECT_THAT(image, HasSubstr("<mode>close</mode>"));
  EXPECT_THAT(image, HasSubstr("<DehazeMode>auto</DehazeMode>"));
  EXPECT_THAT(server.requests(), Not(testing::Contains("PUT /ISAPI/System/time")));
}

TEST(SettingsApply, SaysWhenARebootIsNeeded) {
  CameraHabits habits;
  habits.wants_reboot = true;
  const IsapiServer server(habits);
  EXPECT_TRUE(applyTo(server, everything()).needs_reboot);
}

TEST(SettingsApply, ReportsWhatACameraDoesNotTake) {
  CameraHabits habits;
  habits.ignores_image_changes = true;
  habits.takes_parts = false;
  const IsapiServer server(habits);
  Selection selection;
  selection.settings["wdr"] = std::nullopt;
  const ApplyResult result = applyTo(server, selection);
  EXPECT_FALSE(result.results[0].is_taken);
  EXPECT_THAT(result.results[0].problem, HasSubstr("404"));
}

TEST(SettingsApply, StopsWithoutPermission) {
  CameraHabits habits;
  habits.may_write = false;
  const IsapiServer server(habits);
  const ApplyResult result = applyTo(server, everything());
  EXPECT_THAT(result.failure, HasSubstr("Remote: Parameters Settings"));
  for (const ChangeResult& one : result.results)
    EXPECT_EQ(one.problem, "it was not changed");
  EXPECT_THAT(server.requests(), testing::Contains(testing::StartsWith("PUT")).Times(1));
}

TEST(SettingsApply, ReportsWhatWasChangedBeforeAFailure) {
  CameraHabits habits;
  habits.puts_left = 1;
  const IsapiServer server(habits);
  const ApplyResult result = applyTo(server, everything());
  EXPECT_THAT(result.failure, HasSubstr("Remote: Parameters Settings"));
  for (const ChangeResult& one : result.results) {
    const bool is_first = one.change.setting.document == Document::stream;
    EXPECT_EQ(one.is_taken, is_first) << one.change.setting.name;
    EXPECT_EQ(one.problem, is_first ? "" : "it was not changed") << one.change.setting.name;
  }
}

/// The cameras' changes of the time server: "camera's server now -> planned"; "" if it stays.
std::array<std::string, 2> plannedTimeServers(const std::array<std::string, 2>& servers,
                                              const OdometryNeeds& needs,
                                              const std::optional<std::string>& wish = std::nullopt) {
  std::vector<CameraDocuments> cameras;
  for (const std::string& server : servers) {
    const IsapiServer camera({}, test::replaced(test::factoryDocuments(), "time.windows.com", server));
    cameras.push_back(test::readSimulatedCamera(camera));
  }
  Selection selection;
  selection.settings["time-server"] = wish;
  const ChangePlan plan = planChanges({&cameras[0], &cameras[1]}, needs, selection);
  std::array<std::string, 2> planned;
  for (std::size_t i = 0; i < planned.size(); ++i)
    for (const Change& change : plan.changes[i])
      planned[i] = change.to;
  return planned;
}

TEST(SettingsPlan, GivesEachCameraATimeServerThatItReaches) {
  using Servers = std::array<std::string, 2>;
  OdometryNeeds two_ports;
  two_ports.host_addresses = {"10.0.0.5", "192.168.101.1", "192.168.102.1"};
  two_ports.addresses_near = {"192.168.101.1", "192.168.102.1"};
  EXPECT_EQ(plannedTimeServers({"192.168.101.1", "time.windows.com"}, two_ports),
            (Servers{"", "192.168.102.1"}));
  EXPECT_EQ(plannedTimeServers({"time.windows.com", "192.168.102.1"}, two_ports),
            (Servers{"192.168.101.1", ""}));
  EXPECT_EQ(plannedTimeServers({"192.168.101.1", "192.168.101.1"}, two_ports),
            (Servers{"", "192.168.102.1"}));
  EXPECT_EQ(plannedTimeServers({"192.168.101.1", "192.168.102.1"}, two_ports), (Servers{"", ""}));
  EXPECT_EQ(plannedTimeServers({"time.windows.com", "time.windows.com"}, two_ports, "10.0.0.5"),
            (Servers{"192.168.101.1", "192.168.102.1"}));
  // Servers elsewhere, and cameras in networks of which this computer has no address.
  EXPECT_EQ(plannedTimeServers({"pool.example", "time.windows.com"}, two_ports),
            (Servers{"", "pool.example"}));
  two_ports.addresses_near = {};
  EXPECT_EQ(plannedTimeServers({"time.windows.com", "10.0.0.5"}, two_ports), (Servers{"10.0.0.5", ""}));
}

TEST(SettingsPlan, LeadsBothCamerasToOneValue) {
  const IsapiServer left;
  const IsapiServer right(
      {}, test::replaced(test::replaced(test::factoryDocuments(), ">50hz<", ">60hz<"), "1/500,", ""));
  const CameraDocuments documents[]{test::readSimulatedCamera(left), test::readSimulatedCamera(right)};
  Selection selection;
  selection.all = true;
  const ChangePlan plan = planChanges({&documents[0], &documents[1]}, {}, selection);
  const auto target_of = [](const std::vector<Change>& changes, const std::string& name) {
    const auto found = std::find_if(changes.begin(), changes.end(),
                                    [&](const Change& change) { return change.setting.name == name; });
    return found == changes.end() ? std::string("unchanged") : found->to;
  };
  EXPECT_EQ(target_of(plan.changes[0], "mains-frequency"), "unchanged");
  EXPECT_EQ(target_of(plan.changes[1], "mains-frequency"), "50hz");
  EXPECT_EQ(target_of(plan.changes[0], "shutter"), target_of(plan.changes[1], "shutter"));
  EXPECT_THAT(plan.problems[0], IsEmpty());
}

TEST(SettingsPlan, LeavesGoodSettingsAndTheCalibrationAlone) {
  const IsapiServer server(
      {}, test::replaced(test::factoryDocuments(), "<ImageFlip><enabled>false", "<ImageFlip><enabled>true"));
  const ChangePlan plan = planFor(server, everything());
  for (const Change& change : plan.changes[0])
    EXPECT_THAT(change.setting.name, testing::Not(testing::AnyOf("flip", "width", "height", "codec", "blc")));
}

TEST(SettingsPlan, LeavesASwitchThatIsOffByAnyName) {
  const IsapiServer server({},
                           test::replaced(test::factoryDocuments(), "<mode>open</mode>", "<mode>off</mode>"));
  Selection selection;
  selection.settings["wdr"] = "off";
  selection.settings["blc"] = std::nullopt;
  EXPECT_TRUE(planFor(server, selection).isEmpty());
}

TEST(SettingsPlan, NamesWhatACameraDoesNotOffer) {
  const IsapiServer server;
  Selection selection;
  selection.settings["frame-rate"] = "17";
  selection.settings["hlc"] = std::nullopt;
  selection.settings["bit-rate"] = "much";
  const ChangePlan plan = planFor(server, selection);
  EXPECT_TRUE(plan.isEmpty());
  EXPECT_THAT(plan.problems[0],
              testing::UnorderedElementsAre(HasSubstr("frame-rate: cannot be 17: the camera offers 6"),
                                            HasSubstr("hlc: the camera does not report it"),
                                            HasSubstr("bit-rate: cannot be much: expected a number")));
}

TEST(SettingsPlan, RejectsUnknownNames) {
  const IsapiServer server;
  Selection selection;
  selection.settings["sharpnes"] = std::nullopt;
  EXPECT_THAT(test::messageOf([&] { planFor(server, selection); }),
              HasSubstr("there is no setting 'sharpnes'; the settings are stabilisation, "));
}

}  // namespace
}  // namespace cartvo
