// State of a login and result of a request, as cameras answer.
#include "capture/isapi/isapi_answers.hpp"

#include <gtest/gtest.h>

namespace cartvo::capture {
namespace {

TEST(LoginState, ReadsALock) {
  const LoginState state = parseLoginState(
      "<userCheck xmlns='urn:x'><statusValue>401</statusValue><isActivated>true</isActivated>"
      "<lockStatus>lock</lockStatus><unlockTime> 1800 </unlockTime></userCheck>");
  EXPECT_TRUE(state.isLocked());
  EXPECT_EQ(state.unlock_after, std::chrono::seconds(1800));
  EXPECT_EQ(state.activated, true);
  EXPECT_EQ(loginStateText(state), "the camera has locked this login for another 1800 s");
}

TEST(LoginState, DoesNotKnowWhenALockOfZeroSecondsEnds) {
  const LoginState state =
      parseLoginState("<userCheck><lockStatus>lock</lockStatus><unlockTime>0</unlockTime></userCheck>");
  EXPECT_TRUE(state.isLocked());
  EXPECT_EQ(state.unlock_after, std::nullopt);
  EXPECT_EQ(loginStateText(state), "the camera has locked this login");
}

TEST(LoginState, ReadsTheAttemptsThatAreLeft) {
  const LoginState state = parseLoginState(
      "<userCheck><lockStatus>unlock</lockStatus><unlockTime>0</unlockTime><retryLoginTime>1</retryLoginTime>"
      "</userCheck>");
  EXPECT_FALSE(state.isLocked());
  EXPECT_EQ(state.unlock_after, std::nullopt);
  EXPECT_EQ(loginStateText(state), "1 attempt is left before the camera locks the login");
}

TEST(LoginState, IsUnknownForOtherAnswers) {
  for (const char* body : {"", "<html>no", "<userCheck><unlockTime>-3</unlockTime></userCheck>"}) {
    const LoginState state = parseLoginState(body);
    EXPECT_EQ(state.locked, std::nullopt);
    EXPECT_EQ(state.activated, std::nullopt);
    EXPECT_EQ(loginStateText(state), "");
  }
}

TEST(ResponseStatus, ReadsCodes) {
  const ResponseStatus busy = parseResponseStatus(
      "<ResponseStatus><statusCode>2</statusCode><statusString>Device Busy</statusString></ResponseStatus>");
  EXPECT_EQ(busy.code, ResponseStatus::Code::busy);
  EXPECT_EQ(busy.text, "Device Busy");
  const ResponseStatus reboot = parseResponseStatus(
      "<ResponseStatus><statusCode>1</statusCode><subStatusCode>rebootRequired</subStatusCode></"
      "ResponseStatus>");
  EXPECT_EQ(reboot.code, ResponseStatus::Code::reboot_required);
  EXPECT_TRUE(
      parseResponseStatus("<R><statusCode>4</statusCode><subStatusCode>notSupport</subStatusCode></R>")
          .isNotSupported());
  EXPECT_EQ(parseResponseStatus("<R><statusCode>99</statusCode></R>").code, ResponseStatus::Code::unknown);
}

}  // namespace
}  // namespace cartvo::capture
