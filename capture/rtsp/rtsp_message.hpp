#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Messages of RTSP (RFC 2326, 4 and 6). Everything here comes from the network: sizes are bounded.

namespace cartvo::capture {

/// Largest head (first line and headers) of a message, bytes.
inline constexpr std::size_t kMaxRtspHead = 16U << 10;
/// Largest body, bytes: a session description has less than one kilobyte.
inline constexpr std::size_t kMaxRtspBody = 64U << 10;

/// Head of a message: a response, or a request from the server.
struct RtspHead {
  int status = 0;      ///< of a response; 0: a request
  std::string reason;  ///< the response's phrase, or the request's first line; printable
  std::vector<std::pair<std::string, std::string>> headers;  ///< names in lower case

  /// Value of the first header of this name (lower case), or nothing.
  std::optional<std::string_view> header(std::string_view name) const;
  /// Value of a header that is a non-negative decimal number, or nothing.
  std::optional<std::size_t> number(std::string_view name) const;
};

/// A response with its body.
struct RtspResponse {
  RtspHead head;
  std::string body;
};

/// Parses a head up to and including its empty line. Nothing if its first line is not RTSP.
std::optional<RtspHead> parseRtspHead(std::string_view text);

/// Value of a parameter of a header such as "RTP/AVP/TCP;unicast;interleaved=0-1"; nothing if it is missing.
/// Ignores the case of the name, and blanks around name and value.
std::optional<std::string_view> headerParameter(std::string_view header, std::string_view name);

/// The number at the beginning of a text; nothing if there is none.
std::optional<int> leadingNumber(std::optional<std::string_view> text);

/// Text from the network for a message to the user: one line, printable, at most 120 bytes.
std::string quotedForMessage(std::string_view text);

/// "404 Not Found" of a response.
std::string statusText(const RtspHead& head);

}  // namespace cartvo::capture
