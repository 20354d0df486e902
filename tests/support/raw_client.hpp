#pragma once

#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace cartvo::test {

/// A connection to a server on this computer that sends what the test says and reads only when asked.
class RawClient {
 public:
  /// `receive_buffer`: bytes; 0: as the operating system chooses.
  explicit RawClient(int port, int receive_buffer = 0) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0)
      setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~RawClient() { close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  /// Returns false if the server has disconnected.
  bool send(const std::string& text) {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
  }

  /// All that the server sends until it disconnects.
  std::string receive() {
    std::string text(65536, '\0');
    std::string all;
    for (ssize_t count = 0; (count = recv(socket_, text.data(), text.size(), 0)) > 0;)
      all.append(text, 0, static_cast<std::size_t>(count));
    return all;
  }

 private:
  int socket_;
};

}  // namespace cartvo::test
