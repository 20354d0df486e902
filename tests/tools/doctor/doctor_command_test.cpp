// `cartvo doctor` as a user runs it, on simulated cameras and on a recording.
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "support/camera/isapi_server.hpp"
#include "support/doctor/walls.hpp"
#include "support/file_text.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools/run_cartvo.hpp"
#include "support/tools/run_on_terminal.hpp"

namespace cartvo {
namespace {

using test::CommandResult;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kCanary = "canary-7Fq2";

/// Two cameras with RTSP and ISAPI, and a configuration that names them. LCM's port is no other program's.
class DoctorCommand : public testing::Test {
 protected:
  void SetUp() override {
    calib::writeRig(folder_ / "rig.yaml", test::wallsRig());
    writePassword(kCanary);
  }

  void startCameras(test::CameraHabits habits) {
    habits.password = kCanary;
    left_ = test::wallsCamera(true, kCanary);
    right_ = test::wallsCamera(false, kCanary);
    left_page_ = std::make_unique<test::IsapiServer>(habits);
    right_page_ = std::make_unique<test::IsapiServer>(
        habits, test::withSerialNumber(test::factoryDocuments(), "second"), "127.0.0.2", left_page_->port());
    writeConfiguration(left_->url(), right_->url());
  }

  void writeConfiguration(const std::string& left, const std::string& right) {
    constexpr int kFirstPort = 20'000, kPorts = 20'000;
    std::ofstream(folder_ / "cartvod.yaml")
        << "cameras:\n  left: {url: '" << left << "', username: admin, password_file: password}\n"
        << "  right: {url: '" << right << "', username: admin, password_file: password}\n"
        << "rig: rig.yaml\nlcm: {url: 'udpm://239.255.76.67:" << kFirstPort + ::getpid() % kPorts
        << "?ttl=0'}\n";
  }

  void writePassword(const std::string& password) {
    std::ofstream(folder_ / "password") << password << "\n";
    std::filesystem::permissions(folder_ / "password",
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  }

  /// Runs it on the configuration. No output holds the password.
  CommandResult run(const std::string& arguments) {
    CommandResult result = test::pipeCartvo(commandLine(arguments));
    EXPECT_THAT(result.output, Not(HasSubstr(kCanary)));
    return result;
  }

  std::string commandLine(const std::string& arguments) const {
    const std::string port = left_page_ ? " --http-port " + std::to_string(left_page_->port()) : "";
    return "doctor " + (folder_ / "cartvod.yaml").string() + port + " " + arguments;
  }

  /// The verdict and the text of a finding in JSON.
  static std::string finding(const nlohmann::json& json, const std::string& area,
                             const std::string& subject) {
    for (const nlohmann::json& one : json["findings"]) {
      if (one["area"] == area && one["subject"] == subject)
        return one["verdict"].get<std::string>() + ": " + one["seen"].get<std::string>();
    }
    return "missing";
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<simulate::SimulatedCamera> left_, right_;
  std::unique_ptr<test::IsapiServer> left_page_, right_page_;
};

TEST_F(DoctorCommand, LooksAtTwoCameras) {
  startCameras({});
  const std::filesystem::path report = folder_ / "doctor.html";
  const CommandResult result = run("--json --seconds 2 --report " + report.string());
  ASSERT_EQ(result.exit_code == 3 || result.exit_code == 4, true) << result.output;
  const nlohmann::json json = nlohmann::json::parse(result.output);
  EXPECT_THAT(finding(json, "files", "rig"), HasSubstr("ok: "));
  EXPECT_THAT(finding(json, "left camera", "login"), HasSubstr("ok: user 'admin'"));
  EXPECT_THAT(finding(json, "right camera", "setting wdr"), "look_at: open");
  EXPECT_THAT(finding(json, "left camera", "size"), "ok: 320x240");
  EXPECT_THAT(finding(json, "right camera", "codec"), "ok: H.264");
  EXPECT_THAT(finding(json, "right camera", "frame rate"), HasSubstr("Hz by the camera's clock"));
  EXPECT_THAT(finding(json, "left camera", "sender reports"), HasSubstr("they agree within"));
  EXPECT_THAT(finding(json, "odometry", "processing time"), HasSubstr("of the frame period"));
  EXPECT_THAT(finding(json, "pictures", "left camera, light"), HasSubstr("mean"));
  EXPECT_THAT(finding(json, "cartvod", "service"), HasSubstr("not_checked"));
  const std::string html = test::contentsOf(report);
  EXPECT_THAT(html, HasSubstr("data:image/jpeg"));
  EXPECT_THAT(html, Not(HasSubstr(kCanary)));
  EXPECT_THAT(left_page_->requests(), Not(testing::Contains(testing::StartsWith("PUT"))));
  EXPECT_EQ(left_page_->mostAtOnce(), 1);
}

TEST_F(DoctorCommand, ShowsOnATerminalTheTimeThatIsLeft) {
  startCameras({});
  const std::string output = test::runOnTerminal(commandLine("--seconds 2")).output;
  EXPECT_THAT(output, HasSubstr("\r\033[Kasking the left camera\r\033[K"));
  EXPECT_THAT(output,
              HasSubstr("\r\033[Kmeasuring the streams for 2 s: [..............................] 0/2 s, "
                        "0:02 left\r\033[K"));
  EXPECT_THAT(output, HasSubstr("1/2 s, 0:01 left\r\033[K"));
  EXPECT_THAT(output, HasSubstr("\r\033[Kprocessing some pairs"));
}

TEST_F(DoctorCommand, PrintsPlainLinesOfProgressIntoPipes) {
  startCameras({});
  const std::string output = test::runWithAllProgress(commandLine("--seconds 2")).output;
  EXPECT_THAT(output, HasSubstr("measuring the streams for 2 s\n["));
  EXPECT_THAT(output, HasSubstr("] 1/2 s, 0:01 left\n"));
  EXPECT_THAT(output, Not(HasSubstr("\033")));
}

TEST_F(DoctorCommand, SendsAWrongPasswordOnceAndOpensNoStream) {
  startCameras({});
  writePassword("wrong-canary-7Fq2");
  const CommandResult result = run("");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.output, HasSubstr("broken       login: the camera at http://127.0.0.1:"));
  EXPECT_THAT(result.output, HasSubstr("4 attempts are left"));
  EXPECT_THAT(result.output, Not(HasSubstr("stream:")));
  EXPECT_EQ(left_page_->wrongPasswords(), 1);
  EXPECT_EQ(right_page_->wrongPasswords(), 1);
}

TEST_F(DoctorCommand, SendsNoPasswordToALockedCamera) {
  test::CameraHabits locked;
  locked.is_locked = true;
  startCameras(locked);
  const CommandResult result = run("");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.output, HasSubstr("locked this login"));
  EXPECT_THAT(left_page_->received(), Not(HasSubstr("Authorization")));
}

TEST_F(DoctorCommand, FindsCamerasThatAreOff) {
  startCameras({});
  const std::string left = left_->url(), right = right_->url();
  left_.reset();
  right_.reset();
  const CommandResult result = run("");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.output, HasSubstr("broken       address: "));
  EXPECT_THAT(result.output, HasSubstr("see that the camera has power"));
}

TEST_F(DoctorCommand, EndsEarlyAtAnInterruption) {
  startCameras({});
  const CommandResult result = test::runCommand(
      "timeout --signal=INT 4 " + test::cartvoProgram().string() + " doctor --seconds 1000 --http-port " +
      std::to_string(left_page_->port()) + " " + (folder_ / "cartvod.yaml").string() + " 2>&1");
  EXPECT_THAT(result.output, HasSubstr("interrupted: not all was checked"));
  EXPECT_THAT(result.output, Not(HasSubstr("no picture")));
}

TEST_F(DoctorCommand, LooksAtARecording) {
  test::recordWalls(folder_ / "drive");
  const CommandResult result = test::pipeCartvo("doctor --json " + (folder_ / "drive").string());
  ASSERT_NE(result.exit_code, 1) << result.output;
  const nlohmann::json json = nlohmann::json::parse(result.output);
  EXPECT_THAT(finding(json, "source", "recording"), HasSubstr("ok: 1 segment,"));
  EXPECT_THAT(finding(json, "left camera", "frame rate"), HasSubstr("ok: 20.000 Hz"));
  EXPECT_THAT(finding(json, "odometry", "odometry"), HasSubstr("pairs valid"));
}

TEST_F(DoctorCommand, CallsAMissingConfigurationBroken) {
  const CommandResult text = run("");
  EXPECT_EQ(text.exit_code, 4) << text.output;
  EXPECT_THAT(text.output, HasSubstr("broken       configuration: " + (folder_ / "cartvod.yaml").string()));
  EXPECT_THAT(text.output, HasSubstr("1 broken, "));
  const CommandResult json = run("--json");
  EXPECT_EQ(json.exit_code, 4);
  EXPECT_EQ(nlohmann::json::parse(json.output)["verdict"], "broken");
}

TEST_F(DoctorCommand, RefusesAReportThatCannotBeWrittenBeforeAnyCheck) {
  const CommandResult result =
      test::runCartvo("doctor /nonexistent.yaml --report " + (folder_ / "rig.yaml/a.html").string());
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, Not(HasSubstr("broken")));
}

TEST_F(DoctorCommand, RefusesAWrongCommandLine) {
  EXPECT_EQ(test::runCartvo("doctor --seconds 0").exit_code, 2);
  EXPECT_EQ(test::runCartvo("doctor --http-port 70000").exit_code, 2);
  EXPECT_EQ(test::runCartvo("doctor a b").exit_code, 2);
}

}  // namespace
}  // namespace cartvo
