// URLs of LCM: its defaults, other providers, the variable LCM_DEFAULT_URL.
#include "daemon/publish/lcm_url.hpp"

#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_message.hpp"

namespace cartvo::daemon {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string errorOf(const std::string& url) {
  return test::messageOf([&] { parseLcmUrl(url); });
}

TEST(LcmUrl, HasTheDefaultsOfLcm) {
  EXPECT_EQ(parseLcmUrl("udpm://").text(), "239.255.76.67:7667");
  EXPECT_EQ(parseLcmUrl("udpm://239.1.2.3").url(), "udpm://239.1.2.3:7667");
  EXPECT_EQ(parseLcmUrl("udpm://:7700?recv_buf_size=100000&ttl=2").url(),
            "udpm://239.255.76.67:7700?recv_buf_size=100000&ttl=2");
  EXPECT_EQ(parseLcmUrl("udpm://?ttl=2").ttl, 2);
  EXPECT_EQ(parseLcmUrl("udpm://").ttl, 0);
}

TEST(LcmUrl, OfOtherProvidersIsNamed) {
  for (const char* provider : {"tcpq", "memq", "file", "eclm"})
    EXPECT_THAT(
        errorOf(std::string(provider) + "://127.0.0.1:7700"),
        AllOf(HasSubstr(std::string("provider '") + provider + "'"), HasSubstr("UDP multicast only")));
}

TEST(LcmUrl, IsRefusedWithTheReason) {
  EXPECT_THAT(errorOf("udpm://239.255.76.67:7667?recv_buf_size=9&tll=1"), HasSubstr("has the option 'tll'"));
  EXPECT_THAT(errorOf("239.255.76.67:7667"), HasSubstr("is not a URL of LCM's UDP multicast"));
  EXPECT_THAT(errorOf("udpm://239.255.76.67:7667?ttl=x"), HasSubstr("is not a URL of LCM's UDP multicast"));
  EXPECT_THAT(errorOf("udpm://10.0.0.1:7667"), HasSubstr("not a multicast address"));
  EXPECT_THAT(errorOf("udpm://239.1.2.3:0"), HasSubstr("port"));
  EXPECT_THAT(errorOf("udpm://239.1.2.3?ttl=300"), HasSubstr("ttl"));
  EXPECT_THAT(errorOf("udpm://239.1.2.3?ttl=1000"), HasSubstr("ttl"));
}

TEST(LcmUrl, IsThatOfTheVariableWhereNoneIsGiven) {
  ::unsetenv("LCM_DEFAULT_URL");
  EXPECT_EQ(defaultLcmUrl(), kDefaultLcmUrl);
  ::setenv("LCM_DEFAULT_URL", "", 1);
  EXPECT_EQ(defaultLcmUrl(), kDefaultLcmUrl);
  ::setenv("LCM_DEFAULT_URL", "tcpq://", 1);
  EXPECT_EQ(defaultLcmUrl(), "tcpq://");
  EXPECT_THAT(errorOf("tcpq://"), HasSubstr("LCM_DEFAULT_URL"));
  EXPECT_EQ(describeLcmUrl("tcpq://"), "tcpq:// (LCM_DEFAULT_URL)");
  ::unsetenv("LCM_DEFAULT_URL");
}

}  // namespace
}  // namespace cartvo::daemon
