// Messages as they leave: LCM's format, and who receives them whatever the routes are.
#include "daemon/publish/message_sender.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include <arpa/inet.h>
#include <cartvo/odometry_t.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "daemon/publish/lcm_connection.hpp"
#include "daemon/publish/lcm_url.hpp"
#include "support/error_message.hpp"
#include "support/test_timeout.hpp"

namespace cartvo::daemon {
namespace {

constexpr std::uint16_t kPort = 7669;

/// Receives at the port of the group as LCM does, but is in no group: that of a program which joined by
/// another interface than the message comes by.
class OtherInterface {
 public:
  OtherInterface() : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(kPort);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~OtherInterface() { close(socket_); }
  OtherInterface(const OtherInterface&) = delete;
  OtherInterface& operator=(const OtherInterface&) = delete;

  std::string receive() const {
    pollfd waiting{socket_, POLLIN, 0};
    std::array<char, 4096> bytes{};
    if (poll(&waiting, 1, static_cast<int>(test::kTestTimeout.count() * 1000)) != 1) return {};
    const ssize_t count = recv(socket_, bytes.data(), bytes.size(), 0);
    return count < 0 ? "" : std::string(bytes.data(), static_cast<std::size_t>(count));
  }

 private:
  int socket_;
};

TEST(GroupSender, ReachesProgramsThatJoinedByAnotherInterface) {
  const OtherInterface program;
  GroupSender sender("udpm://239.255.76.67:" + std::to_string(kPort) + "?ttl=0");
  odometry_t message{};
  message.sequence = 42;
  ASSERT_TRUE(sender.publish(kOdometryChannel, message)) << sender.error();
  const std::string datagram = program.receive();
  const std::string head = std::string("LC02\0\0\0\0", 8) + kOdometryChannel + std::string(1, '\0');
  ASSERT_GT(datagram.size(), head.size());
  EXPECT_EQ(datagram.substr(0, head.size()), head);
  odometry_t received{};
  const auto bytes = static_cast<int>(datagram.size() - head.size());
  EXPECT_EQ(received.decode(datagram.data() + head.size(), 0, bytes), bytes);
  EXPECT_EQ(received.sequence, 42);
}

TEST(GroupSender, SaysWhyAMessageIsNotSent) {
  GroupSender sender("udpm://239.255.76.67:" + std::to_string(kPort) + "?ttl=0");
  EXPECT_FALSE(sender.publish(std::string(70'000, 'a'), odometry_t{}));
  EXPECT_EQ(sender.error(), std::strerror(EMSGSIZE));
}

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
