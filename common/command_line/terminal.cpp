// Width of terminals and of text on them.
#include "common/command_line/terminal.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include <sys/ioctl.h>
#include <unistd.h>

namespace cartvo {
namespace {

bool startsCharacter(char byte) {
  constexpr unsigned kContinuationMask = 0xC0, kContinuation = 0x80;
  return (static_cast<unsigned char>(byte) & kContinuationMask) != kContinuation;
}

/// Where the text begins that continues a line, see wrapLines.
std::size_t continuationIndent(const std::string& line, std::size_t columns) {
  constexpr std::size_t kDeeper = 8;
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t gap = line.find("  ", begin);
  const std::size_t second = gap == std::string::npos ? gap : line.find_first_not_of(' ', gap);
  if (second < 2 * columns / 3) return second;
  const bool is_first_column = begin > 0 && begin < 2 * kDeeper;
  return is_first_column ? begin + kDeeper : begin;
}

/// A line without its line feed, broken as by wrapLines.
std::string wrapLine(std::string line, std::size_t columns) {
  const std::size_t indent = continuationIndent(line, columns);
  std::string wrapped;
  while (textColumns(line) > columns) {
    std::size_t end = line.find(' ', indent + 1), next = end;
    while (next != std::string::npos && textColumns(std::string_view(line).substr(0, next)) <= columns) {
      end = next;
      next = line.find(' ', next + 1);
    }
    if (end == std::string::npos) break;
    wrapped += line.substr(0, end) + "\n";
    line = std::string(indent, ' ') + line.substr(end + 1);
  }
  return wrapped + line;
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

std::string wrapLines(const std::string& text, std::size_t columns) {
  std::string wrapped;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    wrapped += wrapLine(line, columns) + "\n";
  return wrapped;
}

}  // namespace cartvo
