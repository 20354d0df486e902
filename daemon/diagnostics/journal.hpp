#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include <spdlog/common.h>
#include <spdlog/sinks/sink.h>

// Log lines with fields, by which the journal finds them: journalctl -u cartvod CARTVO_EVENT=camera_state.

namespace cartvo::daemon {

/// Field of a log line. The journal takes names of capitals, digits and underscores
/// (systemd.journal-fields(7)).
struct LogField {
  const char* name;
  std::string value;
};

/// Logs a line through spdlog. Its fields reach the journal only; a terminal shows the text.
void logEvent(spdlog::level::level_enum level, const std::string& text,
              std::initializer_list<LogField> fields);

/// Takes the fields of one line, each "NAME=value", to the journal. Returns false if it could not.
using JournalSender = std::function<bool(const std::vector<std::string>& fields)>;

/// Sink that sends each line with its fields to the journal (sd_journal_sendv(3)), or, without a journal, the
/// text to standard error. `send` is for tests.
std::shared_ptr<spdlog::sinks::sink> makeJournalSink(JournalSender send = {});

}  // namespace cartvo::daemon
