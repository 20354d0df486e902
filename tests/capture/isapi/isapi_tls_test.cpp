// TLS with certificates that cameras sign themselves.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/isapi/isapi_client.hpp"
#include "capture/isapi/known_cameras.hpp"
#include "support/camera/isapi_server.hpp"
#include "support/error_message.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::capture {
namespace {

using testing::HasSubstr;

test::CameraHabits tlsHabits() {
  test::CameraHabits habits;
  habits.tls = true;
  return habits;
}

IsapiSettings settingsFor(const test::IsapiServer& server, const std::string& key) {
  IsapiSettings settings;
  settings.address = {"127.0.0.1", static_cast<std::uint16_t>(server.port()), true};
  settings.credentials = {"admin", "camera-password"};
  settings.key = key;
  return settings;
}

TEST(IsapiTls, ReadsFromTheCameraWhoseKeyWasKept) {
  const test::IsapiServer server(tlsHabits());
  const IsapiSettings settings = settingsFor(server, "");
  const std::string key = HttpConnection(settings.address, settings.timeout).fetchKey();
  EXPECT_THAT(key, testing::MatchesRegex("sha256//[A-Za-z0-9+/]*="));
  EXPECT_EQ(server.received(), "") << "a key is fetched without a request";
  IsapiClient client(settingsFor(server, key));
  EXPECT_EQ(client.get("/ISAPI/System/time").rootName(), "Time");
}

TEST(IsapiTls, SendsNothingToADeviceWithAnotherKey) {
  const test::IsapiServer camera(tlsHabits()), impostor(tlsHabits());
  const IsapiSettings settings = settingsFor(camera, "");
  const std::string key = HttpConnection(settings.address, settings.timeout).fetchKey();
  IsapiClient client(settingsFor(impostor, key));
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
