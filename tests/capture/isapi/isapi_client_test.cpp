// Client of ISAPI against a camera over real HTTP. TLS with certificates that cameras sign themselves.
#include "capture/isapi/isapi_client.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/camera/isapi_server.hpp"
#include "support/closed_port.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::capture {
namespace {

using test::CameraHabits;
using test::IsapiServer;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kTime = "/ISAPI/System/time";

IsapiSettings settingsFor(const IsapiServer& server, const std::string& password = "camera-password") {
  IsapiSettings settings;
  settings.address = {"127.0.0.1", static_cast<std::uint16_t>(server.port()), false};
  settings.credentials = {"admin", password};
  settings.retry_pause = std::chrono::milliseconds(1);
  return settings;
}

/// The error of a call; fails the test if it throws none.
template <typename Call>
IsapiError errorOf(Call call) {
  try {
    call();
  } catch (const IsapiError& error) {
    return error;
  }
  ADD_FAILURE() << "no IsapiError";
  return {IsapiError::Kind::busy, ""};
}

TEST(IsapiClient, ReadsWithDigestOnlyAndOneRequestAtATime) {
  const IsapiServer server;
  IsapiClient client(settingsFor(server));
  EXPECT_EQ(client.get(kTime).text("timeMode"), "manual");
  EXPECT_EQ(client.get("/ISAPI/System/deviceInfo").text("model"), "DS-2CD2143G2-I");
  EXPECT_EQ(server.mostAtOnce(), 1);
  EXPECT_THAT(server.received(), Not(HasSubstr("camera-password")));
  EXPECT_THAT(server.received(), Not(HasSubstr("Basic")));
}

TEST(IsapiClient, AsksForTheLockBeforeItSendsAPassword) {
  const IsapiServer server({.is_locked = true});
  IsapiClient client(settingsFor(server));
  const IsapiError error = errorOf([&] { client.get(kTime); });
  EXPECT_EQ(error.kind(), IsapiError::Kind::login_locked);
  EXPECT_EQ(error.login().unlock_after, std::chrono::seconds(1799));
  EXPECT_THAT(error.what(), HasSubstr("for another 1799 s"));
  EXPECT_THAT(server.received(), Not(HasSubstr("Authorization")));
}

TEST(IsapiClient, SendsARefusedPasswordOnce) {
  const IsapiServer server;
  IsapiClient client(settingsFor(server, "canary-wrong"));
  const IsapiError error = errorOf([&] { client.get(kTime); });
  EXPECT_EQ(error.kind(), IsapiError::Kind::login_refused);
  EXPECT_EQ(error.login().attempts_left, 4);
  EXPECT_THAT(error.what(), HasSubstr("4 attempts are left"));
  EXPECT_THAT(error.what(), Not(HasSubstr("canary-wrong")));
  EXPECT_EQ(server.wrongPasswords(), 1);
  const std::string before = server.received();
  EXPECT_STREQ(errorOf([&] { client.get(kTime); }).what(), error.what());
  EXPECT_EQ(server.received(), before) << "the same client sends nothing more";
}

TEST(IsapiClient, SendsAPasswordTwiceAtMostToACameraThatCallsEachNonceOld) {
  const IsapiServer server({.always_stale = true});
  IsapiClient client(settingsFor(server, "canary-wrong"));
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(errorOf([&] { client.get(kTime); }).kind(), IsapiError::Kind::login_refused);
  EXPECT_EQ(server.wrongPasswords(), 2);
}

TEST(IsapiClient, SendsAPasswordThatChangedTwiceAtMost) {
  CameraHabits habits;
  IsapiServer server(habits);
  IsapiClient client(settingsFor(server));
  client.get(kTime);
  habits.password = "another";
  server.setHabits(habits);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(errorOf([&] { client.get(kTime); }).kind(), IsapiError::Kind::login_refused);
  EXPECT_EQ(server.wrongPasswords(), 2);
}

TEST(IsapiClient, AnswersNoChallengeThatStatesALock) {
  for (const bool knows_user_check : {true, false}) {
    CameraHabits habits;
    habits.knows_user_check = knows_user_check;
    IsapiServer server(habits);
    IsapiClient client(settingsFor(server));
    client.get(kTime);
    CameraHabits locked = habits;
    locked.is_locked = true;
    server.setHabits(locked);
    server.forgetNonces();
    const std::size_t before = server.received().size();
    for (int i = 0; i < 3; ++i) {
      const IsapiError error = errorOf([&] { client.get(kTime); });
      EXPECT_EQ(error.kind(), IsapiError::Kind::login_locked);
      EXPECT_EQ(error.login().unlock_after, std::chrono::seconds(1799));
    }
    const std::string sent = server.received().substr(before);
    EXPECT_EQ(sent.find("Authorization"), sent.rfind("Authorization")) << "the one of the running session";
    server.setHabits(habits);
    EXPECT_EQ(client.get(kTime).rootName(), "Time") << "unlocked";
  }
}

TEST(IsapiClient, ReportsACameraThatIsNotActivated) {
  const IsapiServer server({.is_activated = false});
  IsapiClient client(settingsFor(server));
  EXPECT_EQ(errorOf([&] { client.get(kTime); }).kind(), IsapiError::Kind::not_activated);
}

TEST(IsapiClient, DoesWithoutUserCheck) {
  const IsapiServer server({.knows_user_check = false});
  IsapiClient client(settingsFor(server));
  EXPECT_EQ(client.loginState().locked, std::nullopt);
  EXPECT_EQ(client.get(kTime).rootName(), "Time");
}

TEST(IsapiClient, AnswersSha256AndBothAlgorithms) {
  for (const std::vector<std::string>& algorithms :
       {std::vector<std::string>{"SHA-256"}, {"MD5", "SHA-256"}, {"SHA-256", "MD5"}}) {
    const IsapiServer server({.algorithms = algorithms});
    IsapiClient client(settingsFor(server));
    EXPECT_EQ(client.get(kTime).rootName(), "Time");
    EXPECT_THAT(server.received(), HasSubstr("algorithm=SHA-256"));
  }
}

TEST(IsapiClient, TakesANewNonceWhenOneDies) {
  for (const bool says_stale : {true, false}) {
    CameraHabits habits;
    habits.nonce_uses = 2;
    habits.says_stale = says_stale;
    IsapiServer server(habits);
    IsapiClient client(settingsFor(server));
    for (int i = 0; i < 5; ++i)
      EXPECT_EQ(client.get(kTime).rootName(), "Time");
    server.forgetNonces();
    EXPECT_EQ(client.get(kTime).rootName(), "Time");
    EXPECT_EQ(server.wrongPasswords(), 0);
  }
}

TEST(IsapiClient, WaitsForACameraThatStartsOrIsBusy) {
  const IsapiServer server({.booting_answers = 3, .busy_answers = 2});
  IsapiClient client(settingsFor(server));
  EXPECT_EQ(client.get(kTime).rootName(), "Time");
}

TEST(IsapiClient, GivesUpOnACameraThatStaysBusy) {
  const IsapiServer server({.busy_answers = 1000});
  IsapiClient client(settingsFor(server));
  EXPECT_EQ(errorOf([&] { client.get(kTime); }).kind(), IsapiError::Kind::busy);
  EXPECT_EQ(server.requests().size(), 1U + 1U + 5U) << "user check, first attempt, five more";
}

TEST(IsapiClient, TellsMissingPermissionFromAWrongPassword) {
  const IsapiServer server({.may_write = false});
  IsapiClient client(settingsFor(server));
  const XmlDocument time = client.get(kTime);
  const IsapiError error = errorOf([&] { client.put(kTime, time); });
  EXPECT_EQ(error.kind(), IsapiError::Kind::forbidden);
  EXPECT_THAT(error.what(), HasSubstr("the password is right"));
  EXPECT_THAT(error.what(), HasSubstr("Remote: Parameters Settings"));
}

TEST(IsapiClient, LeavesOutWhatACameraDoesNotHave) {
  const IsapiServer server;
  IsapiClient client(settingsFor(server));
  EXPECT_FALSE(client.getIfSupported("/ISAPI/Missing").has_value());
  EXPECT_EQ(errorOf([&] { client.get("/ISAPI/Missing"); }).kind(), IsapiError::Kind::not_supported);
}

TEST(IsapiClient, WritesAndSaysWhenARebootIsNeeded) {
  for (const bool wants_reboot : {false, true}) {
    const IsapiServer server({.wants_reboot = wants_reboot});
    IsapiClient client(settingsFor(server));
    XmlDocument time = client.get(kTime);
    time.setTexts("timeMode", "NTP");
    EXPECT_EQ(client.put(kTime, time), wants_reboot);
    EXPECT_THAT(server.document(kTime), HasSubstr("<timeMode>NTP</timeMode>"));
  }
}

TEST(IsapiClient, SurvivesAReboot) {
  const IsapiServer server;
  IsapiClient client(settingsFor(server));
  EXPECT_TRUE(client.answers());
  client.reboot();
  EXPECT_FALSE(client.answers()) << "it starts";
  EXPECT_EQ(client.get(kTime).rootName(), "Time");
}

TEST(IsapiClient, NamesAnAddressWhereNothingAnswers) {
  const test::ClosedPort closed;
  IsapiSettings settings;
  settings.address = {"127.0.0.1", closed.port(), false};
  IsapiClient client(settings);
  EXPECT_FALSE(client.answers());
  try {
    client.get(kTime);
    ADD_FAILURE();
  } catch (const HttpError& error) {
    EXPECT_EQ(error.kind(), HttpError::Kind::unreachable);
    EXPECT_THAT(error.what(),
                HasSubstr("http://127.0.0.1:" + std::to_string(closed.port()) + " cannot be reached"));
  }
}

IsapiSettings tlsSettingsFor(const IsapiServer& server, const std::string& key) {
  IsapiSettings settings = settingsFor(server);
  settings.address.tls = true;
  settings.key = key;
  return settings;
}

TEST(IsapiTls, ReadsFromTheCameraWhoseKeyWasKept) {
  const IsapiServer server({.tls = true});
  const IsapiSettings settings = tlsSettingsFor(server, "");
  const std::string key = HttpConnection(settings.address, settings.timeout).fetchKey();
  EXPECT_THAT(key, testing::MatchesRegex("sha256//[A-Za-z0-9+/]*="));
  EXPECT_EQ(server.received(), "") << "a key is fetched without a request";
  IsapiClient client(tlsSettingsFor(server, key));
  EXPECT_EQ(client.get("/ISAPI/System/time").rootName(), "Time");
}

TEST(IsapiTls, SendsNothingToADeviceWithAnotherKey) {
  const IsapiServer camera({.tls = true}), impostor({.tls = true});
  const IsapiSettings settings = tlsSettingsFor(camera, "");
  const std::string key = HttpConnection(settings.address, settings.timeout).fetchKey();
  IsapiClient client(tlsSettingsFor(impostor, key));
  try {
    client.get("/ISAPI/System/time");
    ADD_FAILURE();
  } catch (const HttpError& error) {
    EXPECT_EQ(error.kind(), HttpError::Kind::wrong_key);
    EXPECT_THAT(error.what(), HasSubstr("no password was sent"));
  }
  EXPECT_EQ(impostor.received(), "");
}

TEST(KnownCameras, KeepsKeys) {
  const test::TemporaryFolder folder;
  const HttpAddress left{"10.0.0.1", 443, true}, right{"10.0.0.2", 443, true};
  KnownCameras known(folder / "known");
  EXPECT_EQ(known.keyOf(left), std::nullopt);
  known.add(left, "sha256//aaaa=");
  known.add(right, "sha256//bbbb=");
  const KnownCameras again(folder / "known");
  EXPECT_EQ(again.keyOf(left), "sha256//aaaa=");
  EXPECT_EQ(again.keyOf(right), "sha256//bbbb=");
}

TEST(KnownCameras, NamesALineThatIsNone) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "known") << "# comment\n10.0.0.1:443 md5//x\n";
  EXPECT_THAT(test::messageOf([&] { KnownCameras(folder / "known"); }),
              HasSubstr("known:2: expected HOST:PORT"));
}

}  // namespace
}  // namespace cartvo::capture
