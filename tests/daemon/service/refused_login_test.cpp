// Question to a camera why it refused a login.
#include "daemon/service/refused_login.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/camera/isapi_server.hpp"
#include "support/closed_port.hpp"

namespace cartvo::daemon {
namespace {

using testing::HasSubstr;

capture::RefusedLogin ask(int port) {
  const std::atomic<bool> interrupted = false;
  return askAboutRefusedLogin({"127.0.0.1", static_cast<std::uint16_t>(port), false},
                              std::chrono::seconds(10), interrupted);
}

TEST(RefusedLogin, TellsForHowLongTheCameraHasLockedIt) {
  test::CameraHabits habits;
  habits.is_locked = true;
  const test::IsapiServer server(habits);
  const capture::RefusedLogin refusal = ask(server.port());
  EXPECT_EQ(refusal.locked_for, std::chrono::seconds(1799));
  EXPECT_THAT(refusal.text, HasSubstr("locked this login for another 1799 s"));
  EXPECT_THAT(server.received(), testing::Not(HasSubstr("Authorization")));
}

TEST(RefusedLogin, TellsHowManyAttemptsAreLeft) {
  const test::IsapiServer server;
  const capture::RefusedLogin refusal = ask(server.port());
  EXPECT_EQ(refusal.locked_for, std::nullopt);
  EXPECT_THAT(refusal.text, HasSubstr("5 attempts are left"));
}

TEST(RefusedLogin, IsEmptyForOtherDevices) {
  test::CameraHabits habits;
  habits.knows_user_check = false;
  const test::IsapiServer server(habits);
  EXPECT_EQ(ask(server.port()).text, "");
  const test::ClosedPort closed;
  EXPECT_EQ(ask(closed.port()).text, "") << "nothing answers";
}

}  // namespace
}  // namespace cartvo::daemon
