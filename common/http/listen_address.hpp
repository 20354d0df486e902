#pragma once

#include <cstdint>
#include <string>

namespace cartvo {

/// Whether the text is an IPv4 address of four numbers.
bool isIpv4Address(const std::string& text);

/// Whether the text is an IPv4 or IPv6 address.
bool isNumericAddress(const std::string& text);

/// Address and port that an HTTP server listens at.
struct ListenAddress {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: any free port

  /// Parses PORT or ADDRESS:PORT with a numeric address (an IPv6 one in brackets) or localhost, for
  /// 127.0.0.1. Throws std::invalid_argument naming the text.
  static ListenAddress parse(const std::string& text);

  bool isLoopback() const;

  /// ADDRESS:PORT, as `parse` reads it.
  std::string text() const;
};

}  // namespace cartvo
