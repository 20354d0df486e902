// Addresses that HTTP servers listen at.
#include "common/http/listen_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/error_message.hpp"

namespace cartvo {
namespace {

using testing::HasSubstr;

TEST(ListenAddress, IsAPortOrAddressAndPort) {
  EXPECT_EQ(ListenAddress::parse("81").port, 81);
  EXPECT_TRUE(ListenAddress::parse("81").isLoopback());
  EXPECT_EQ(ListenAddress::parse("0.0.0.0:81").address, "0.0.0.0");
  EXPECT_FALSE(ListenAddress::parse("0.0.0.0:81").isLoopback());
  EXPECT_EQ(ListenAddress::parse("[::1]:81").address, "::1");
  EXPECT_TRUE(ListenAddress::parse("[::1]:81").isLoopback());
  EXPECT_EQ(ListenAddress::parse("[::1]:81").text(), "[::1]:81");
  EXPECT_EQ(ListenAddress::parse("81").text(), "127.0.0.1:81");
  EXPECT_EQ(ListenAddress::parse("localhost:81").text(), "127.0.0.1:81");
  for (const char* const wrong : {"", "live", "70000", "-1", "cart:80", "127.0.0.1:", "1.2.3:80", "80 "}) {
    EXPECT_THAT(test::messageOf([&] { ListenAddress::parse(wrong); }),
                HasSubstr("is neither PORT nor ADDRESS:PORT"))
        << wrong;
  }
}

}  // namespace
}  // namespace cartvo
