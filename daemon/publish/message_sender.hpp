#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <netinet/in.h>

namespace cartvo::daemon {

/// Sends messages of types that lcm-gen generates.
class MessageSender {
 public:
  MessageSender() = default;
  virtual ~MessageSender() = default;
  MessageSender(const MessageSender&) = delete;
  MessageSender& operator=(const MessageSender&) = delete;

  /// False if the operating system refuses to send it.
  template <typename Message>
  bool publish(const std::string& channel, const Message& message) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    return send(channel, bytes);
  }

 protected:
  virtual bool send(const std::string& channel, const std::vector<std::uint8_t>& message) = 0;
};

/// Sends to the multicast group of an LCM URL, in LCM's format for messages of one datagram.
///
/// LCM's own sender leaves the interface to the routing table at each message. When the route changes,
/// messages with ttl=0 leave the host by the new interface (the kernel looks at their ttl only where the host
/// is a member of the group), and programs that joined the group earlier receive none. With ttl=0 this sender
/// uses the loopback interface whatever the routes are, and is a member of the group there: the kernel then
/// gives the messages to all LCM programs of the host, whatever interface they joined by. With other ttl the
/// route decides.
class GroupSender final : public MessageSender {
 public:
  /// Throws std::invalid_argument for a wrong URL, std::runtime_error if the socket cannot be set up or the
  /// host has no route for the group, without which LCM programs cannot subscribe; the message says how to
  /// add it.
  explicit GroupSender(const std::string& url);
  ~GroupSender() override;

  /// Why the last message that failed was not sent; empty: none failed.
  const std::string& error() const { return error_; }

 private:
  bool send(const std::string& channel, const std::vector<std::uint8_t>& message) override;

  int socket_;
  sockaddr_in destination_{};
  std::uint32_t sequence_ = 0;
  std::vector<std::uint8_t> datagram_;
  std::string error_;
};

}  // namespace cartvo::daemon
