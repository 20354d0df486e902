// Log lines in the journal's own protocol, with fields.
#include "daemon/diagnostics/journal.hpp"

#include <cstdio>
#include <mutex>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>
#include <sys/uio.h>
#include <systemd/sd-journal.h>

namespace cartvo::daemon {
namespace {

/// Fields of the line that this thread is logging: spdlog's messages have none.
thread_local std::span<const LogField> current_fields;

/// Priority by which journalctl -p filters (syslog(3)).
int priorityOf(spdlog::level::level_enum level) {
  if (level <= spdlog::level::debug) return 7;
  if (level == spdlog::level::warn) return 4;
  return level >= spdlog::level::err ? 3 : 6;
}

bool sendToJournal(const std::vector<std::string>& fields) {
  std::vector<iovec> parts;
  parts.reserve(fields.size());
  for (const std::string& field : fields)
    parts.push_back({const_cast<char*>(field.data()), field.size()});  // the journal does not write to it
  return sd_journal_sendv(parts.data(), static_cast<int>(parts.size())) == 0;
}

class JournalSink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit JournalSink(JournalSender send) : send_(std::move(send)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string text(message.payload.data(), message.payload.size());
    std::vector<std::string> fields{"MESSAGE=" + text, fmt::format("PRIORITY={}", priorityOf(message.level)),
                                    "SYSLOG_IDENTIFIER=cartvod"};
    for (const LogField& field : current_fields)
      fields.push_back(std::string(field.name) + "=" + field.value);
    if (!send_(fields)) fmt::print(stderr, "<{}>{}\n", priorityOf(message.level), text);
  }
  void flush_() override {}

  JournalSender send_;
};

}  // namespace

void logEvent(spdlog::level::level_enum level, const std::string& text,
              std::initializer_list<LogField> fields) {
  current_fields = std::span(fields.begin(), fields.size());
  spdlog::log(level, text);
  current_fields = {};
}

std::shared_ptr<spdlog::sinks::sink> makeJournalSink(JournalSender send) {
  return std::make_shared<JournalSink>(send ? std::move(send) : sendToJournal);
}

}  // namespace cartvo::daemon
