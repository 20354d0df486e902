// Camera passwords: read from files that other users cannot read, and from systemd credentials.

#include "daemon/service/camera_password.hpp"

#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace cartvo::daemon {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class CameraPassword : public testing::Test {
 protected:
  CameraConfiguration camera(const std::string& password, fs::perms permissions) {
    CameraConfiguration camera;
    camera.username = "admin";
    camera.password_file = folder_ / "password";
    std::ofstream(camera.password_file) << password;
    fs::permissions(camera.password_file, permissions);
    return camera;
  }
  static std::string errorOf(const CameraConfiguration& camera) {
    try {
      readPassword(camera);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    ADD_FAILURE() << "accepted";
    return {};
  }

  static constexpr fs::perms kOwner = fs::perms::owner_read | fs::perms::owner_write;
  test::TemporaryFolder folder_;
};

TEST_F(CameraPassword, IsOnlyLineOfFile) {
  EXPECT_EQ(readPassword(camera("correct horse\n", kOwner)), "correct horse");
  EXPECT_EQ(readPassword(camera("windows\r\n", kOwner)), "windows");
  EXPECT_EQ(readPassword(camera("no newline", kOwner | fs::perms::group_read)), "no newline");
}

TEST_F(CameraPassword, IsReadFromFilesOfWindows) {
  using namespace std::string_literals;
  EXPECT_EQ(readPassword(camera("\xEF\xBB\xBF"
                                "gr\u00FCn \u20AC\r\n",
                                kOwner)),
            "gr\u00FCn \u20AC");
  EXPECT_EQ(readPassword(camera("\xFF\xFEg\0\xFC\0\r\0\n\0"s, kOwner)), "g\u00FC");
  EXPECT_EQ(readPassword(camera("\xFE\xFF\0g\0\xFC\0\n"s, kOwner)), "g\u00FC");
  EXPECT_EQ(readPassword(camera("a line below\n\n \n", kOwner)), "a line below");
}

TEST_F(CameraPassword, IsRefusedIfItIsAmbiguous) {
  using namespace std::string_literals;
  for (const std::string& text : {"secret "s, " secret"s, "secret\t\r\n"s, "secret\u00A0"s, "\u200Bsecret"s})
    EXPECT_THAT(errorOf(camera(text, kOwner)),
                testing::AllOf(HasSubstr("begins or ends with a blank"), testing::Not(HasSubstr("secret"))));
  for (const std::string& text : {"s\0e\0c\0\r\0\n\0"s, "gr\xFCn\n"s, "sec\tret"s})
    EXPECT_THAT(errorOf(camera(text, kOwner)), HasSubstr("it is not UTF-8, or holds control characters"));
  EXPECT_THAT(errorOf(camera("admin\nsecret\n", kOwner)), HasSubstr("several lines"));
}

TEST_F(CameraPassword, IsRefusedIfOtherUsersMayReadFile) {
  EXPECT_THAT(errorOf(camera("secret\n", kOwner | fs::perms::others_read)),
              testing::AllOf(HasSubstr("chmod o="), testing::Not(HasSubstr("secret"))));
}

TEST_F(CameraPassword, IsRefusedIfFileIsMissingEmptyOrTooLong) {
  CameraConfiguration missing = camera("x", kOwner);
  missing.password_file = folder_ / "none";
  EXPECT_THAT(errorOf(missing), HasSubstr("none: cannot be read"));
  EXPECT_THAT(errorOf(camera("", kOwner)), HasSubstr("found none"));
  EXPECT_THAT(errorOf(camera("\r\n", kOwner)), HasSubstr("found none"));
  EXPECT_THAT(errorOf(camera(std::string(2000, 'x'), kOwner)), HasSubstr("one line"));
}

TEST_F(CameraPassword, IsReadFromSystemdCredential) {
  const CameraConfiguration file = camera("from systemd\n", kOwner);
  CameraConfiguration credential;
  credential.username = "admin";
  credential.password_credential = "password";
  unsetenv("CREDENTIALS_DIRECTORY");
  EXPECT_THAT(errorOf(credential), HasSubstr("LoadCredential=password"));
  setenv("CREDENTIALS_DIRECTORY", folder_.path().c_str(), 1);
  EXPECT_EQ(readPassword(credential), "from systemd");
  unsetenv("CREDENTIALS_DIRECTORY");
}

TEST_F(CameraPassword, IsReadFromCredentialsBesideTheConfigurationOutsideSystemd) {
  CameraConfiguration credential;
  credential.username = "admin";
  credential.password_credential = "left-camera-password";
  credential.credentials = folder_ / "credentials";
  unsetenv("CREDENTIALS_DIRECTORY");
  EXPECT_THAT(
      errorOf(credential),
      testing::AllOf(HasSubstr("'left-camera-password' is not to be found here"),
                     HasSubstr("$CREDENTIALS_DIRECTORY is not set"),
                     HasSubstr((folder_ / "credentials/left-camera-password").string() + " does not exist")));
  fs::create_directory(credential.credentials);
  std::ofstream(credential.credentials / "left-camera-password") << "beside\n";
  fs::permissions(credential.credentials / "left-camera-password", kOwner);
  EXPECT_EQ(readPassword(credential), "beside");
  setenv("CREDENTIALS_DIRECTORY", (folder_ / "of systemd").c_str(), 1);
  EXPECT_EQ(readPassword(credential), "beside") << "systemd's folder has no such file";
  fs::create_directory(folder_ / "of systemd");
  std::ofstream(folder_ / "of systemd/left-camera-password") << "from systemd\n";
  fs::permissions(folder_ / "of systemd/left-camera-password", kOwner);
  EXPECT_EQ(readPassword(credential), "from systemd");
  unsetenv("CREDENTIALS_DIRECTORY");
}

TEST_F(CameraPassword, IsEmptyWithoutUserName) {
  EXPECT_EQ(readPassword(CameraConfiguration{}), "");
}

}  // namespace
}  // namespace cartvo::daemon
