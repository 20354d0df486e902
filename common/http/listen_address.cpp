// Addresses that servers listen at.
#include "common/http/listen_address.hpp"

#include <array>
#include <charconv>
#include <stdexcept>

#include <arpa/inet.h>

namespace cartvo {
namespace {

bool isAddress(int family, const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> bytes{};
  return inet_pton(family, text.c_str(), bytes.data()) == 1;
}

}  // namespace

bool isIpv4Address(const std::string& text) {
  return isAddress(AF_INET, text);
}

bool isNumericAddress(const std::string& text) {
  return isIpv4Address(text) || isAddress(AF_INET6, text);
}

ListenAddress ListenAddress::parse(const std::string& text) {
  ListenAddress result;
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  if (colon != std::string::npos) {
    result.address = text.substr(0, colon);
    if (result.address == "localhost") result.address = "127.0.0.1";
    if (result.address.starts_with('[') && result.address.ends_with(']'))
      result.address = result.address.substr(1, result.address.size() - 2);
  }
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), result.port);
  if (error != std::errc() || end != port.data() + port.size() || port.empty() ||
      !isNumericAddress(result.address)) {
    throw std::invalid_argument(
        "'" + text +
        "' is neither PORT nor ADDRESS:PORT with a numeric address or localhost, such as "
        "8600 or 127.0.0.1:8600");
  }
  return result;
}

bool ListenAddress::isLoopback() const {
  return address == "::1" || (isIpv4Address(address) && address.starts_with("127."));
}

std::string ListenAddress::text() const {
  const bool is_version_6 = address.find(':') != std::string::npos;
  return (is_version_6 ? "[" + address + "]" : address) + ":" + std::to_string(port);
}

}  // namespace cartvo
