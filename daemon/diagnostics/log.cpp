// Log set-up for the journal or a terminal, and the rate limit for repeated warnings.

#include "daemon/diagnostics/log.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include "daemon/diagnostics/journal.hpp"

namespace cartvo::daemon {
namespace {

/// True if standard error goes to the journal (systemd.exec(5), $JOURNAL_STREAM).
bool logsToJournal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  if (stream == nullptr || fstat(STDERR_FILENO, &status) != 0) return false;
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino) == stream;
}

constexpr std::chrono::minutes kRepeatPeriod{1};
constexpr std::size_t kMaxTexts = 64;

/// Whether a word, without the signs around it, is a number.
bool isNumber(std::string_view word) {
  const std::size_t begin = word.find_first_of("0123456789");
  const std::size_t last = word.find_last_of("0123456789");
  if (begin == std::string_view::npos) return false;
  if (word.find_first_not_of("+-\u00b1(") != begin) return false;
  if (word.find_first_not_of(".,;:)%", last + 1) != std::string_view::npos) return false;
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data() + begin, word.data() + last + 1, value);
  return error == std::errc{} && end == word.data() + last + 1;
}

std::string withoutNumbers(std::string_view text) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    result.append(isNumber(word) ? "#" : word).append(" ");
    begin = end + 1;
  }
  return result;
}

}  // namespace

void setUpLog(spdlog::level::level_enum level) {
  const bool journal = logsToJournal();
  spdlog::sink_ptr sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  if (journal) sink = makeJournalSink();
  auto logger = std::make_shared<spdlog::logger>("cartvod", std::move(sink));
  if (!journal) logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
  logger->set_level(level);
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(std::move(logger));
}

std::string RepeatedWarnings::due(const std::string& text, Clock::time_point now) {
  const std::string key = withoutNumbers(text);
  const auto found = entries_.find(key);
  if (found == entries_.end()) {
    if (entries_.size() >= kMaxTexts) entries_.clear();
    entries_.emplace(key, Entry{now, 0});
    return text;
  }
  Entry& entry = found->second;
  ++entry.repeats;
  if (now - entry.logged < kRepeatPeriod) return {};
  std::string line = text + " (" + std::to_string(entry.repeats) + " times since this was last logged)";
  entry = {now, 0};
  return line;
}

void RepeatedWarnings::forget(const std::string& text) {
  entries_.erase(withoutNumbers(text));
}

void RepeatedWarnings::warn(const std::string& text) {
  const std::string line = due(text, Clock::now());
  if (!line.empty()) spdlog::warn(line);
}

}  // namespace cartvo::daemon
