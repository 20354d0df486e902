// Width of terminals and of text on them.
#include "common/command_line/terminal.hpp"

#include <algorithm>
#include <cstdlib>

#include <sys/ioctl.h>
#include <unistd.h>

namespace cartvo {
namespace {

bool startsCharacter(char byte) {
  constexpr unsigned kContinuationMask = 0xC0, kContinuation = 0x80;
  return (static_cast<unsigned char>(byte) & kContinuationMask) != kContinuation;
}

}  // namespace

std::optional<TerminalSize> terminalSize(int descriptor) {
  winsize size{};
  const bool is_known = ::isatty(descriptor) == 1 && ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 &&
                        size.ws_col > 0 && size.ws_row > 0;
  return is_known ? std::optional(TerminalSize{size.ws_col, size.ws_row}) : std::nullopt;
}

std::optional<std::size_t> terminalColumns(int descriptor) {
  constexpr std::size_t kUsual = 80;
  constexpr int kMaxColumns = 10'000;
  if (::isatty(descriptor) != 1) return std::nullopt;
  winsize size{};
  if (::ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* columns = std::getenv("COLUMNS");
  const int given = columns == nullptr ? 0 : std::atoi(columns);
  return given > 0 ? static_cast<std::size_t>(std::min(given, kMaxColumns)) : kUsual;
}

std::size_t lineColumns(std::FILE* stream) {
  constexpr std::size_t kUnlimited = 1000;
  return terminalColumns(fileno(stream)).value_or(kUnlimited + 1) - 1;
}

std::size_t textColumns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), startsCharacter));
}

std::string cutToColumns(const std::string& text, std::size_t columns) {
  constexpr std::string_view kCut = "...";
  if (textColumns(text) <= columns) return text;
  std::size_t kept = columns > kCut.size() ? columns - kCut.size() : 0;
  std::size_t end = 0;
  for (; end < text.size(); ++end) {
    if (startsCharacter(text[end]) && kept-- == 0) break;
  }
  return text.substr(0, end) + std::string(kCut.substr(0, columns));
}

}  // namespace cartvo
