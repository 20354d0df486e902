// Checks of configuration, rig file and passwords, with good and bad files.
#include "tools/doctor/configuration_checks.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/format/rig_file.hpp"
#include "support/calib/rigs.hpp"
#include "support/doctor/findings.hpp"
#include "support/temporary_folder.hpp"

namespace cartvo::doctor {
namespace {

using test::findingOf;
using test::Saw;
using testing::HasSubstr;
using testing::Not;

class ConfigurationChecks : public testing::Test {
 protected:
  void writeConfiguration(const std::string& extra) {
    std::ofstream(folder_ / "cartvod.yaml")
        << "cameras:\n"
           "  left: {url: 'rtsp://192.168.1.64/1', username: admin, password_file: password}\n"
           "  right: {url: 'rtsp://192.168.1.65/1', username: admin, password_file: password}\n"
        << extra << "rig: rig.yaml\n";
  }

  void writePassword(const std::string& text, std::filesystem::perms permissions) {
    std::ofstream(folder_ / "password") << text;
    std::filesystem::permissions(folder_ / "password", permissions);
  }

  daemon::CameraConfiguration camera() const {
    daemon::CameraConfiguration camera;
    camera.url = "rtsp://192.168.1.64/1";
    camera.username = "admin";
    camera.password_file = folder_ / "password";
    return camera;
  }

  static constexpr auto kPrivate = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
  test::TemporaryFolder folder_;
  FindingList list_{"files"};
};

TEST_F(ConfigurationChecks, AcceptsAConfiguration) {
  writeConfiguration("");
  EXPECT_TRUE(checkConfiguration(folder_ / "cartvod.yaml", list_));
  EXPECT_THAT(findingOf(list_.findings(), "configuration"), Saw(Verdict::ok, "in order"));
}

TEST_F(ConfigurationChecks, NamesFileAndKeyOfAWrongConfiguration) {
  writeConfiguration("nonsense: 1\n");
  EXPECT_FALSE(checkConfiguration(folder_ / "cartvod.yaml", list_));
  EXPECT_THAT(findingOf(list_.findings(), "configuration"), Saw(Verdict::broken, "nonsense"));
}

TEST_F(ConfigurationChecks, DoesNotRepeatAPasswordThatIsInTheConfiguration) {
  std::ofstream(folder_ / "cartvod.yaml")
      << "cameras:\n  left: {url: 'rtsp://admin:canary@192.168.1.64/1'}\n  right: {password: canary}\n";
  EXPECT_FALSE(checkConfiguration(folder_ / "cartvod.yaml", list_));
  EXPECT_THAT(areaText(list_.findings()), Not(HasSubstr("canary")));
}

TEST_F(ConfigurationChecks, LooksAtTheThesisEstimator) {
  vo::OdometrySettings settings;
  settings.estimator = vo::Estimator::thesis;
  checkOdometrySettings(settings, list_);
  EXPECT_THAT(findingOf(list_.findings(), "estimator"), Saw(Verdict::look_at, "thesis"));
}

TEST_F(ConfigurationChecks, SaysThatARigFileIsMissingOrWrong) {
  daemon::Configuration configuration;
  configuration.rig = folder_ / "rig.yaml";
  EXPECT_FALSE(checkRigFile(configuration, list_));
  EXPECT_THAT(list_.findings().back(), Saw(Verdict::broken, "does not exist"));
  std::ofstream(configuration.rig) << "left: 1\n";
  EXPECT_FALSE(checkRigFile(configuration, list_));
  EXPECT_THAT(list_.findings().back(), Saw(Verdict::broken, "rig.yaml"));
}

TEST_F(ConfigurationChecks, LooksAtAMissingMountAndAtReadoutsThatDiffer) {
  calib::Rig rig = test::rectifiedRig();
  rig.left.readout = 0.032;
  rig.right.readout = 0.027;
  EXPECT_TRUE(checkRig(rig, "rig.yaml", list_));
  EXPECT_THAT(findingOf(list_.findings(), "mount on the cart"), Saw(Verdict::look_at, "not stated"));
  EXPECT_THAT(findingOf(list_.findings(), "readouts"), Saw(Verdict::look_at, "left 32.0 ms, right 27.0 ms"));
}

TEST_F(ConfigurationChecks, AcceptsAMountedRigWithEqualReadouts) {
  calib::Rig rig = test::rectifiedRig();
  rig.T_body_camera.translation().z() = 1.8;
  rig.left.readout = rig.right.readout = 0.032;
  EXPECT_TRUE(checkRig(rig, "rig.yaml", list_));
  EXPECT_EQ(worstVerdict(list_.findings()), Verdict::ok);
}

TEST_F(ConfigurationChecks, AcceptsAPrivatePassword) {
  writePassword("canary\n", kPrivate);
  EXPECT_TRUE(checkPassword("left", camera(), list_));
  EXPECT_THAT(list_.findings().back(), Saw(Verdict::ok, "mode 600"));
  EXPECT_THAT(areaText(list_.findings()), Not(HasSubstr("canary")));
}

TEST_F(ConfigurationChecks, CallsAPasswordBrokenThatOthersCanRead) {
  writePassword("canary\n", kPrivate | std::filesystem::perms::group_read);
  EXPECT_TRUE(checkPassword("left", camera(), list_)) << "cartvod can use it";
  EXPECT_THAT(list_.findings().back(), Saw(Verdict::broken, "mode 640: its group can read"));
  writePassword("canary\n", kPrivate | std::filesystem::perms::others_read);
  EXPECT_FALSE(checkPassword("left", camera(), list_));
  EXPECT_THAT(list_.findings().back(), Saw(Verdict::broken, "mode 604: all users can read"));
  EXPECT_EQ(list_.findings().size(), 2U);
  EXPECT_THAT(areaText(list_.findings()), Not(HasSubstr("canary")));
}

TEST_F(ConfigurationChecks, SaysThatAPasswordIsMissing) {
  EXPECT_FALSE(checkPassword("left", camera(), list_));
  EXPECT_NE(list_.findings().back().verdict, Verdict::ok);
  EXPECT_THAT(list_.findings().back().seen, HasSubstr("No such file"));
  EXPECT_NE(list_.findings().back().advice, "");
}

TEST_F(ConfigurationChecks, NeedsNoPasswordWithoutAUser) {
  daemon::CameraConfiguration open = camera();
  open.username.clear();
  EXPECT_TRUE(checkPassword("left", open, list_));
  EXPECT_EQ(list_.findings().back().verdict, Verdict::ok);
}

}  // namespace
}  // namespace cartvo::doctor
