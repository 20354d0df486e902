#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "daemon/publish/message_sender.hpp"

namespace cartvo::test {

/// Keeps the messages instead of sending them.
class SentMessages final : public daemon::MessageSender {
 public:
  std::size_t count() const { return sent_.size(); }

  /// The messages of a channel.
  template <typename Message>
  std::vector<Message> on(const std::string& channel) const {
    std::vector<Message> messages;
    for (const auto& [name, bytes] : sent_) {
      if (name == channel) messages.emplace_back().decode(bytes.data(), 0, static_cast<int>(bytes.size()));
    }
    return messages;
  }

 private:
  bool send(const std::string& channel, const std::vector<std::uint8_t>& message) override {
    sent_.emplace_back(channel, message);
    return true;
  }

  std::vector<std::pair<std::string, std::vector<std::uint8_t>>> sent_;
};

}  // namespace cartvo::test
