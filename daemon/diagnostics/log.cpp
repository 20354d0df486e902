// Log set-up for the journal or a terminal, and the rate limit for repeated warnings.

#include "daemon/diagnostics/log.hpp"

#include <cstdlib>
#include <memory>
#include <string>

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

namespace cartvo::daemon {
namespace {

/// True if standard error goes to the journal, which adds the time to each line (systemd.exec(5),
/// $JOURNAL_STREAM).
bool logsToJournal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  if (stream == nullptr || fstat(STDERR_FILENO, &status) != 0) return false;
  return std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino) == stream;
}

constexpr std::chrono::minutes kRepeatPeriod{1};
constexpr std::size_t kMaxTexts = 64;

/// Priority prefix such as "<4>", by which journalctl -p filters (syslog(3)).
class PriorityFlag : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& line) override {
    const char* priority = "<6>";
    if (message.level <= spdlog::level::debug) priority = "<7>";
    if (message.level == spdlog::level::warn) priority = "<4>";
    if (message.level >= spdlog::level::err) priority = "<3>";
    line.append(priority, priority + 3);
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<PriorityFlag>();
  }
};

}  // namespace

void setUpLog(spdlog::level::level_enum level) {
  auto logger =
      std::make_shared<spdlog::logger>("cartvod", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  if (logsToJournal()) {
    auto formatter = std::make_unique<spdlog::pattern_formatter>();
    formatter->add_flag<PriorityFlag>('*').set_pattern("%*%v");
    logger->set_formatter(std::move(formatter));
  } else {
    logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %l: %v");
  }
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
