// Parsing of RTSP messages.

#include "capture/rtsp/rtsp_message.hpp"

#include <algorithm>
#include <charconv>

#include "common/ascii_text.hpp"
#include "common/printable_text.hpp"

namespace cartvo::capture {
namespace {

constexpr std::size_t kMaxHeaders = 100;
constexpr std::size_t kMaxQuoted = 120;

/// Removes and returns the first line, without its end (CR LF, or LF alone).
std::string_view takeLine(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

/// Parses "RTSP/1.0 200 OK" or "OPTIONS rtsp://... RTSP/1.0".
bool parseFirstLine(std::string_view line, RtspHead& head) {
  if (line.starts_with("RTSP/")) {
    const std::size_t space = line.find(' ');
    if (space == std::string_view::npos) return false;
    const std::string_view rest = trimmed(line.substr(space));
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), head.status);
    if (error != std::errc() || head.status < 100 || head.status > 999) return false;
    head.reason = quotedForMessage(trimmed(rest.substr(static_cast<std::size_t>(end - rest.data()))));
    return true;
  }
  if (line.find(" RTSP/") == std::string_view::npos) return false;
  head.reason = quotedForMessage(line);
  return true;
}

}  // namespace

std::optional<std::string_view> RtspHead::header(std::string_view name) const {
  const auto found =
      std::find_if(headers.begin(), headers.end(), [&](const auto& header) { return header.first == name; });
  if (found == headers.end()) return std::nullopt;
  return found->second;
}

std::optional<std::size_t> RtspHead::number(std::string_view name) const {
  const std::optional<std::string_view> text = header(name);
  std::size_t value = 0;
  if (!text) return std::nullopt;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error == std::errc::result_out_of_range) return static_cast<std::size_t>(-1);
  if (error != std::errc() || end != text->data() + text->size()) return std::nullopt;
  return value;
}

std::optional<RtspHead> parseRtspHead(std::string_view text) {
  RtspHead head;
  if (!parseFirstLine(takeLine(text), head)) return std::nullopt;
  while (!text.empty() && head.headers.size() < kMaxHeaders) {
    const std::string_view line = takeLine(text);
    const bool continues = !line.empty() && (line.front() == ' ' || line.front() == '\t');
    if (continues && !head.headers.empty()) {
      head.headers.back().second.append(1, ' ').append(trimmed(line));
      continue;
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;
    head.headers.emplace_back(lowerCase(trimmed(line.substr(0, colon))), trimmed(line.substr(colon + 1)));
  }
  return head;
}

std::optional<std::string_view> headerParameter(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = header.find(';');
    const std::string_view part = header.substr(0, end);
    header.remove_prefix(end == std::string_view::npos ? header.size() : end + 1);
    const std::size_t equals = part.find('=');
    if (equals != std::string_view::npos && lowerCase(trimmed(part.substr(0, equals))) == name)
      return trimmed(part.substr(equals + 1));
  }
  return std::nullopt;
}

std::optional<int> leadingNumber(std::optional<std::string_view> text) {
  int value = 0;
  if (!text || std::from_chars(text->data(), text->data() + text->size(), value).ec != std::errc())
    return std::nullopt;
  return value;
}

std::string quotedForMessage(std::string_view text) {
  std::string result(utf8Prefix(trimmed(text), kMaxQuoted));
  if (!isPrintable(result)) {
    std::replace_if(
        result.begin(), result.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7f; }, '?');
  }
  return result;
}

std::string statusText(const RtspHead& head) {
  return std::to_string(head.status) + (head.reason.empty() ? "" : " " + head.reason);
}

}  // namespace cartvo::capture
