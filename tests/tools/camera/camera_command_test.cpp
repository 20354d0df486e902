// `cartvo camera` as a user runs it, on two cameras over real HTTP.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/camera/isapi_server.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"

namespace cartvo {
namespace {

using test::CameraHabits;
using test::CommandResult;
using test::IsapiServer;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kCanary = "canary-7Fq2";

CameraHabits withPassword(CameraHabits habits = {}) {
  habits.password = kCanary;
  return habits;
}

/// Two cameras at one port of two loopback addresses, and a configuration that names them.
class CameraCommand : public testing::Test {
 protected:
  void SetUp() override { start(withPassword(), withPassword()); }

  void start(const CameraHabits& left, const CameraHabits& right) {
    right_.reset();
    left_ = std::make_unique<IsapiServer>(left);
    right_ = std::make_unique<IsapiServer>(right, test::withSerialNumber(test::factoryDocuments(), "second"),
                                           "127.0.0.2", left_->port());
    std::ofstream(folder_ / "cartvod.yaml") << "cameras:\n"
                                               "  left: {url: 'rtsp://127.0.0.1/Streaming/Channels/101', "
                                               "username: admin, password_file: password}\n"
                                               "  right: {url: 'rtsp://127.0.0.2/Streaming/Channels/101', "
                                               "username: admin, password_file: password}\n"
                                               "  frame_rate: 18\n"
                                               "rig: rig.yaml\n";
    writePassword(kCanary);
  }

  void writePassword(const std::string& password) {
    std::ofstream(folder_ / "password") << password << "\n";
    std::filesystem::permissions(folder_ / "password",
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  }

  /// Runs an action; its output must never hold the password.
  CommandResult run(const std::string& arguments) {
    CommandResult result =
        test::runCartvo("camera " + arguments + " --config " + (folder_ / "cartvod.yaml").string() +
                        " --http-port " + std::to_string(left_->port()) + " < /dev/null");
    EXPECT_THAT(result.output, Not(HasSubstr(kCanary)));
    EXPECT_THAT(left_->received() + right_->received(), Not(HasSubstr(kCanary)));
    return result;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<IsapiServer> left_, right_;
};

TEST_F(CameraCommand, ShowsBothCameras) {
  const CommandResult result = run("show");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("DS-2CD2143G2-I, serial number second, firmware V5.7.3"));
  const CommandResult as_json = run("show --json");
  const nlohmann::json json = nlohmann::json::parse(as_json.output);
  EXPECT_EQ(json["cameras"][1]["settings"]["frame-rate"], "25");
  EXPECT_TRUE(json["cameras"][1]["settings"]["hlc"].is_null());
}

TEST_F(CameraCommand, ChecksAppliesAndIsThenContent) {
  const CommandResult before = run("check");
  EXPECT_EQ(before.exit_code, 3);
  EXPECT_THAT(before.output, HasSubstr("it merges exposures of different instants"));

  const CommandResult dry = run("apply --all --dry-run");
  EXPECT_EQ(dry.exit_code, 0);
  EXPECT_THAT(dry.output, HasSubstr("shutter                1/25 -> 1/500"));
  EXPECT_THAT(left_->requests(), Not(testing::Contains(testing::StartsWith("PUT"))));

  const CommandResult unasked = run("apply --all");
  EXPECT_EQ(unasked.exit_code, 1);
  EXPECT_THAT(unasked.output, HasSubstr("nothing was changed: standard input is no terminal"));
  EXPECT_THAT(left_->requests(), Not(testing::Contains(testing::StartsWith("PUT"))));

  EXPECT_EQ(run("apply --all --json").exit_code, 2) << "would ask";
  const nlohmann::json planned = nlohmann::json::parse(run("apply --all --dry-run --json").output);
  EXPECT_FALSE(planned["cameras"][0]["planned"]["changes"].empty());
  EXPECT_TRUE(planned["cameras"][0]["results"].empty());
  const CommandResult applied = run("apply --all --yes --json");
  EXPECT_EQ(applied.exit_code, 0) << applied.output;
  const nlohmann::json done = nlohmann::json::parse(applied.output);
  for (const nlohmann::json& camera : done["cameras"]) {
    EXPECT_EQ(camera["results"].size(), camera["planned"]["changes"].size());
    for (const nlohmann::json& result : camera["results"])
      EXPECT_EQ(result["taken"], true) << result.dump();
    EXPECT_TRUE(camera["left_over"]["changes"].empty());
  }
  const CommandResult after = run("check --json");
  EXPECT_EQ(after.exit_code, 0) << after.output;
  EXPECT_EQ(nlohmann::json::parse(after.output)["good"], true);
}

TEST_F(CameraCommand, ChangesNothingIfOneCameraCannotBeRead) {
  CameraHabits locked = withPassword();
  locked.is_locked = true;
  start(withPassword(), locked);
  const CommandResult result = run("apply --all --yes");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("nothing was changed"));
  EXPECT_THAT(result.output, HasSubstr("for another 1799 s"));
  EXPECT_THAT(left_->requests(), Not(testing::Contains(testing::StartsWith("PUT"))));
}

TEST_F(CameraCommand, ReportsAWrongPasswordOncePerCamera) {
  writePassword("canary-7Fq2-wrong");
  const CommandResult result = run("check");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("refused the user or password (user 'admin'); 4 attempts are left"));
  EXPECT_EQ(left_->wrongPasswords(), 1);
  EXPECT_EQ(right_->wrongPasswords(), 1);
}

TEST_F(CameraCommand, SaysWhenARebootIsNeededAndReboots) {
  CameraHabits habits = withPassword();
  habits.wants_reboot = true;
  start(withPassword(), habits);
  const CommandResult applied = run("apply wdr --yes");
  EXPECT_EQ(applied.exit_code, 4);
  EXPECT_THAT(applied.output, HasSubstr("cartvo camera reboot --camera right"));
  EXPECT_EQ(run("reboot --camera right").exit_code, 1) << "not agreed";
  const CommandResult reboot = run("reboot --camera right --yes");
  EXPECT_EQ(reboot.exit_code, 0) << reboot.output;
  EXPECT_THAT(right_->requests(), testing::Contains("PUT /ISAPI/System/reboot"));
  EXPECT_THAT(left_->requests(), Not(testing::Contains("PUT /ISAPI/System/reboot")));
}

TEST_F(CameraCommand, WaitsForBothCamerasToReboot) {
  const CommandResult reboot = run("reboot --yes --wait 60");
  EXPECT_EQ(reboot.exit_code, 0) << reboot.output;
  EXPECT_THAT(reboot.output, HasSubstr("the left camera answers again"));
  EXPECT_THAT(reboot.output, HasSubstr("the right camera answers again"));
}

TEST_F(CameraCommand, ReportsAFailureInTheMiddleOfChanges) {
  CameraHabits failing = withPassword();
  failing.puts_left = 1;
  start(failing, withPassword());
  const CommandResult result = run("apply --all --yes");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("left camera: bit-rate-mode is CBR"));
  EXPECT_THAT(result.output, HasSubstr("left camera: wdr is not confirmed: it was not changed"));
  EXPECT_THAT(result.output, HasSubstr("the right camera was not touched"));
  EXPECT_THAT(result.output, HasSubstr("run the same `cartvo camera apply` again"));
  EXPECT_THAT(right_->requests(), Not(testing::Contains(testing::StartsWith("PUT"))));
}

TEST_F(CameraCommand, KeepsTheKeyOfACameraWithTls) {
  CameraHabits habits = withPassword();
  habits.tls = true;
  start(habits, habits);
  const CommandResult first = run("show --https --camera left");
  EXPECT_EQ(first.exit_code, 0) << first.output;
  EXPECT_THAT(first.output, HasSubstr("is kept in " + (folder_ / "known-cameras").string()));
  const CommandResult again = run("show --https --camera left");
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.output, Not(HasSubstr("is kept in")));
  start(habits, habits);  // another key; the free port is another one, too
  std::ofstream(folder_ / "known-cameras")
      << "127.0.0.1:" << left_->port() << " sha256//AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA=\n";
  const CommandResult changed = run("show --https --camera left");
  EXPECT_EQ(changed.exit_code, 1);
  EXPECT_THAT(changed.output, HasSubstr("another key"));
  EXPECT_EQ(left_->received(), "");
}

TEST_F(CameraCommand, WantsToKnowWhatToApply) {
  EXPECT_EQ(run("apply").exit_code, 2);
  EXPECT_EQ(run("apply wdr=").exit_code, 2);
  const CommandResult unknown = run("apply nonsense --yes");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("there is no setting 'nonsense'"));
  EXPECT_EQ(left_->received() + right_->received(), "") << "no camera was asked";
}

}  // namespace
}  // namespace cartvo
