// Arrival of what is read late.

#include <array>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <unistd.h>

#include "capture/network/udp_ports.hpp"
#include "common/host_clock.hpp"

namespace cartvo::capture {
namespace {

constexpr std::int64_t kLate_ns = 20'000'000;

/// Two connected sockets on the loopback interface.
class Sockets {
 public:
  explicit Sockets(int type) {
    const int server = socket(AF_INET, type, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(server, generic, size), 0);
    EXPECT_EQ(getsockname(server, generic, &size), 0);
    if (type == SOCK_STREAM) {
      EXPECT_EQ(listen(server, 1), 0);
    }
    sender = socket(AF_INET, type, 0);
    EXPECT_EQ(connect(sender, generic, size), 0);
    receiver = type == SOCK_STREAM ? accept(server, nullptr, nullptr) : server;
    if (type == SOCK_STREAM) close(server);
  }
  ~Sockets() {
    close(sender);
    close(receiver);
  }
  Sockets(const Sockets&) = delete;
  Sockets& operator=(const Sockets&) = delete;

  int sender = -1;
  int receiver = -1;
};

/// By how much the arrival of a byte that is read late is after its sending, ns.
std::int64_t arrivalAfterSending(const Sockets& sockets, TimedReceiver& receiver) {
  const std::int64_t sent_ns = hostNow();
  EXPECT_EQ(send(sockets.sender, "$", 1, 0), 1);
  pollfd readable{sockets.receiver, POLLIN, 0};
  EXPECT_EQ(poll(&readable, 1, 10'000), 1);
  const std::int64_t late_ns = hostNow() + kLate_ns;
  while (hostNow() < late_ns) {
  }
  std::array<std::uint8_t, 16> data{};
  EXPECT_EQ(receiver.receive(sockets.receiver, data, nullptr), 1);
  return receiver.arrivalNs() - sent_ns;
}

TEST(TimedReceiver, TellsWhenTheKernelReceived) {
  for (const int type : {SOCK_STREAM, SOCK_DGRAM}) {
    const Sockets sockets(type);
    TimedReceiver receiver;
    receiver.begin(sockets.receiver);
    std::int64_t after_ns = kLate_ns;
    // The kernel begins to stamp packets a moment after the first socket has asked for it.
    for (int i = 0; i < 50 && after_ns >= kLate_ns; ++i)
      after_ns = arrivalAfterSending(sockets, receiver);
    EXPECT_LT(after_ns, kLate_ns) << type;
    EXPECT_GT(after_ns, -1'000'000) << type;
  }
}

TEST(TimedReceiver, ArrivalIsAfterTheSocketWasEmpty) {
  const Sockets sockets(SOCK_DGRAM);
  TimedReceiver receiver;
  ASSERT_EQ(send(sockets.sender, "$", 1, 0), 1);
  const std::int64_t begin_ns = hostNow();
  receiver.begin(sockets.receiver);  // a wall clock that is set forward makes a packet older, as here
  std::array<std::uint8_t, 16> data{};
  ASSERT_EQ(receiver.receive(sockets.receiver, data, nullptr), 1);
  EXPECT_GE(receiver.arrivalNs(), begin_ns);
  EXPECT_LE(receiver.arrivalNs(), hostNow());
  EXPECT_LT(recv(sockets.receiver, data.data(), data.size(), MSG_DONTWAIT), 0);
}

}  // namespace
}  // namespace cartvo::capture
