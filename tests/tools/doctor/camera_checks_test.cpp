// Checks of cameras over real HTTP and TCP on loopback.
#include "tools/doctor/cameras/camera_checks.hpp"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/camera/camera_fixture.hpp"
#include "support/camera/isapi_server.hpp"
#include "support/closed_port.hpp"
#include "support/doctor/findings.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::doctor {
namespace {

using test::CameraHabits;
using test::findingOf;
using test::Saw;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kCanary = "canary-7Fq2";

class CameraChecks : public testing::Test {
 protected:
  CameraChecks() {
    configuration_.left.url = "rtsp://127.0.0.1/Streaming/Channels/101";
    configuration_.left.username = "admin";
    configuration_.left.password_file = folder_ / "password";
    std::ofstream(folder_ / "password") << kCanary;
    std::filesystem::permissions(folder_ / "password", std::filesystem::perms::owner_read);
  }

  Findings ask(CameraHabits habits, LoginPermission permission) {
    habits.password = kCanary;
    server_ = std::make_unique<test::IsapiServer>(habits);
    return ask(permission, server_->port());
  }

  Findings ask(LoginPermission permission, int port) {
    FindingList list("left camera");
    answer_ = {};
    AccessOptions access;
    access.side = "left";
    access.http_port = port;
    access.https = https_;
    access.known_cameras = folder_ / "known-cameras";
    askSettings(configuration_, {access, permission}, interrupted_, answer_, list);
    EXPECT_THAT(areaText(list.findings()), Not(HasSubstr(kCanary)));
    return list.take();
  }

  test::TemporaryFolder folder_;
  daemon::Configuration configuration_;
  std::unique_ptr<test::IsapiServer> server_;
  bool https_ = false;
  std::atomic<bool> interrupted_{false};
  CameraAnswer answer_;
};

TEST_F(CameraChecks, ReadSettingsWithOneRequestAtATime) {
  const Findings findings = ask({}, LoginPermission::allowed);
  EXPECT_THAT(findingOf(findings, "login"), Saw(Verdict::ok, "'admin' is accepted"));
  EXPECT_THAT(findingOf(findings, "model"), Saw(Verdict::ok, "DS-2CD2143G2-I"));
  EXPECT_TRUE(answer_.documents);
  EXPECT_EQ(server_->mostAtOnce(), 1);
  EXPECT_THAT(server_->requests(), Not(testing::Contains(testing::StartsWith("PUT"))));
}

TEST_F(CameraChecks, SendAWrongPasswordOnce) {
  std::filesystem::permissions(folder_ / "password", std::filesystem::perms::owner_all);
  std::ofstream(folder_ / "password") << "wrong";
  std::filesystem::permissions(folder_ / "password", std::filesystem::perms::owner_read);
  const Findings findings = ask({}, LoginPermission::allowed);
  EXPECT_THAT(findingOf(findings, "login"), Saw(Verdict::broken, "4 attempts are left"));
  EXPECT_TRUE(answer_.is_refused);
  EXPECT_EQ(server_->wrongPasswords(), 1);
}

TEST_F(CameraChecks, SendNoPasswordToALockedOrFreshCamera) {
  CameraHabits locked;
  locked.is_locked = true;
  EXPECT_THAT(findingOf(ask(locked, LoginPermission::allowed), "login"), Saw(Verdict::broken, "for another"));
  EXPECT_TRUE(answer_.is_refused);
  CameraHabits fresh;
  fresh.is_activated = false;
  EXPECT_EQ(findingOf(ask(fresh, LoginPermission::allowed), "login").verdict, Verdict::broken);
  EXPECT_EQ(server_->wrongPasswords(), 0);
}

TEST_F(CameraChecks, AskOnlyForALockWhereAPasswordMayNotBeSent) {
  CameraHabits locked;
  locked.is_locked = true;
  EXPECT_THAT(findingOf(ask(locked, LoginPermission::refused_already), "login"),
              Saw(Verdict::broken, "for another"));
  EXPECT_THAT(server_->received(), Not(HasSubstr("Authorization")));
  EXPECT_THAT(findingOf(ask({}, LoginPermission::no_password), "login"),
              Saw(Verdict::not_checked, "cannot be read"));
  EXPECT_THAT(server_->received(), Not(HasSubstr("Authorization")));
}

TEST_F(CameraChecks, ReadSettingsOverTlsFromTheCameraWhoseKeyWasKept) {
  https_ = true;
  CameraHabits habits;
  habits.tls = true;
  EXPECT_THAT(findingOf(ask(habits, LoginPermission::allowed), "login"), Saw(Verdict::ok, "is accepted"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "known-cameras"));
  // Another device at the same address.
  habits.password = kCanary;
  const int port = server_->port();
  server_.reset();
  server_ = std::make_unique<test::IsapiServer>(habits, test::factoryDocuments(), "127.0.0.1", port);
  for (const LoginPermission permission : {LoginPermission::allowed, LoginPermission::no_password}) {
    EXPECT_THAT(findingOf(ask(permission, port), "settings"), Saw(Verdict::broken, "no password was sent"));
    EXPECT_EQ(server_->received(), "");
  }
}

TEST_F(CameraChecks, NameADamagedFileOfKnownCameras) {
  https_ = true;
  CameraHabits habits;
  habits.tls = true;
  std::ofstream(folder_ / "known-cameras") << "damaged\n";
  EXPECT_THAT(findingOf(ask(habits, LoginPermission::allowed), "settings"),
              Saw(Verdict::not_checked, "known-cameras:1"));
  EXPECT_EQ(server_->received(), "");
}

TEST_F(CameraChecks, LeaveOutSettingsWithoutAUser) {
  configuration_.left.username.clear();
  EXPECT_THAT(findingOf(ask({}, LoginPermission::allowed), "settings"),
              Saw(Verdict::not_checked, "none are configured"));
  EXPECT_FALSE(answer_.is_refused) << "the stream may need no password";
  EXPECT_EQ(server_->wrongPasswords(), 0);
}

TEST_F(CameraChecks, LeaveOutSettingsOfOtherMakers) {
  const test::ClosedPort closed;
  const Findings findings = ask(LoginPermission::allowed, closed.port());
  EXPECT_THAT(findingOf(findings, "settings"), Saw(Verdict::not_checked, "cannot be reached"));
  EXPECT_FALSE(answer_.is_refused);
}

TEST_F(CameraChecks, FindACameraThatIsOff) {
  const test::ClosedPort closed;
  daemon::CameraConfiguration off = configuration_.left;
  off.url = "rtsp://127.0.0.1:" + std::to_string(closed.port()) + "/1";
  FindingList list("left camera");
  EXPECT_FALSE(checkAddress(configuration_, off, interrupted_, list));
  EXPECT_THAT(list.findings().back(), Saw(Verdict::broken, "refused"));
  server_ = std::make_unique<test::IsapiServer>();
  off.url = "rtsp://127.0.0.1:" + std::to_string(server_->port()) + "/1";
  EXPECT_TRUE(checkAddress(configuration_, off, interrupted_, list));
  EXPECT_THAT(list.findings().back(), Saw(Verdict::ok, "answers"));
}

TEST_F(CameraChecks, SayWhichSettingsAreNotAsNeeded) {
  const test::IsapiServer left, right({}, test::withSerialNumber(test::factoryDocuments(), "second"));
  const CameraDocuments left_documents = test::readSimulatedCamera(left);
  const CameraDocuments right_documents = test::readSimulatedCamera(right);
  FindingList left_list("left camera"), right_list("right camera"), both("both cameras");
  checkSettings({&left_documents, &right_documents}, {}, {&left_list, &right_list, &both});
  const Finding wdr = findingOf(left_list.findings(), "setting wdr");
  EXPECT_THAT(wdr, Saw(Verdict::look_at, "open"));
  EXPECT_THAT(wdr.expected, HasSubstr("off: it merges exposures"));
  EXPECT_EQ(wdr.advice, "cartvo camera apply wdr");
  EXPECT_THAT(findingOf(right_list.findings(), "other settings"), Saw(Verdict::ok, "as odometry needs"));
  EXPECT_TRUE(both.findings().empty()) << areaText(both.findings());
}

TEST_F(CameraChecks, FindOneCameraAtBothAddresses) {
  const test::IsapiServer server;
  const CameraDocuments documents = test::readSimulatedCamera(server);
  FindingList left("left camera"), right("right camera"), both("both cameras");
  checkSettings({&documents, &documents}, {}, {&left, &right, &both});
  EXPECT_THAT(both.findings().back(), Saw(Verdict::broken, "one camera"));
}

}  // namespace
}  // namespace cartvo::doctor
