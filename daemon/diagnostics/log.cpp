// Log set-up for the journal or a terminal, and the rate limit for repeated warnings.

#include "daemon/diagnostics/log.hpp"

#include <cstdlib>
#include <memory>
#include <string>

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
  const auto found = entries_.find(text);
  if (found == entries_.end()) {
    if (entries_.size() >= kMaxTexts) entries_.clear();
    entries_.emplace(text, Entry{now, 0});
    return text;
  }
  Entry& entry = found->second;
  ++entry.repeats;
  if (now - entry.logged < kRepeatPeriod) return {};
  std::string line = text + " (" + std::to_string(entry.repeats) + " times since this was last logged)";
  entry = {now, 0};
  return line;
}

void RepeatedWarnings::warn(const std::string& text) {
  const std::string line = due(text, Clock::now());
  if (!line.empty()) spdlog::warn(line);
}

}  // namespace cartvo::daemon
