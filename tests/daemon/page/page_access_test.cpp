// Token and cookie of the status page.
#include "daemon/page/page_access.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace cartvo::daemon {
namespace {

const std::string kToken = "a-token-of-the-test";

std::string cookieOf(const PageAccess& access) {
  return access.cookie().substr(0, access.cookie().find(';'));
}

TEST(PageAccess, KnowsTheTokenAndItsCookie) {
  const PageAccess access(kToken, PageReaders::token_holders);
  EXPECT_TRUE(access.isToken(kToken));
  for (const char* wrong : {"", "a-token-of-the-tes", "a-token-of-the-test ", "A-token-of-the-test"})
    EXPECT_FALSE(access.isToken(wrong)) << wrong;
  EXPECT_TRUE(access.mayRead(cookieOf(access), ""));
  EXPECT_TRUE(access.mayRead("other=1; " + cookieOf(access) + "; more=2", ""));
  EXPECT_TRUE(access.mayRead("", "Bearer " + kToken));
  for (const char* wrong : {"", "cartvo_page=", "cartvo_page=a-token-of-the-test", "cartvo_page", ";;;=;"})
    EXPECT_FALSE(access.mayRead(wrong, "")) << wrong;
  for (const char* wrong : {"Bearer ", "Bearer wrong", "Basic a-token-of-the-test", "a-token-of-the-test"})
    EXPECT_FALSE(access.mayRead("", wrong)) << wrong;
  EXPECT_FALSE(access.mayRead(cookieOf(access), "Bearer wrong")) << "the header counts";
}

TEST(PageAccess, HasACookieThatScriptsAndOtherSitesDoNotGet) {
  const std::string cookie = PageAccess(kToken, PageReaders::token_holders).cookie();
  EXPECT_EQ(cookie.find(kToken), std::string::npos);
  EXPECT_NE(cookie.find("; HttpOnly; SameSite=Strict;"), std::string::npos);
  EXPECT_NE(cookie, PageAccess(kToken + "2", PageReaders::token_holders).cookie());
  EXPECT_EQ(cookie, PageAccess(kToken, PageReaders::everyone).cookie()) << "valid after a restart";
}

TEST(PageAccess, WithoutATokenNoRequestHoldsIt) {
  const PageAccess access("", PageReaders::everyone);
  EXPECT_TRUE(access.mayRead("", ""));
  EXPECT_FALSE(access.isToken(""));
  EXPECT_FALSE(access.isHolder("cartvo_page=", "Bearer "));
}

TEST(PageAccess, RefusesAShortToken) {
  EXPECT_THROW(PageAccess("12345678901", PageReaders::everyone), std::invalid_argument);
}

TEST(PageAccess, LimitsWrongLogins) {
  PageAccess access(kToken, PageReaders::everyone);
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(access.mayTryLogin());
    access.addWrongLogin();
  }
  EXPECT_FALSE(access.mayTryLogin());
}

TEST(PageAccess, ComparesOriginAndHost) {
  EXPECT_TRUE(isSameOrigin("http://127.0.0.1:9465", "127.0.0.1:9465"));
  EXPECT_FALSE(isSameOrigin("http://127.0.0.1:9466", "127.0.0.1:9465"));
  EXPECT_TRUE(isSameOrigin("https://cart.example", "cart.example")) << "through a proxy";
  EXPECT_FALSE(isSameOrigin("https://attacker.example", "cart.example"));
  EXPECT_FALSE(isSameOrigin("null", "127.0.0.1:9465"));
  EXPECT_FALSE(isSameOrigin("", ""));
  EXPECT_FALSE(isSameOrigin("http://", ""));
}

}  // namespace
}  // namespace cartvo::daemon
