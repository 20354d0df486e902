// Command line of `cartvo doctor`.
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "daemon/service/awaited_signals.hpp"
#include "tools/camera/access_options.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/cartvo/time_option.hpp"
#include "tools/cartvo/work_observer.hpp"
#include "tools/doctor/doctor.hpp"
#include "tools/doctor/report.hpp"
#include "tools/report/html.hpp"

namespace cartvo {
namespace {

// Shows the steps of long work on the error output.

/// Shows on the error output the current step of long work and its progress, as ProgressBar does.
class WorkDisplay {
 public:
  /// For calls in one thread, while this object lives.
  WorkObserver observer();

  /// Ends the current step: on a terminal its line is erased.
  void end() { bar_.reset(); }

 private:
  std::optional<ProgressBar> bar_;
};

WorkObserver WorkDisplay::observer() {
  return {[this](const WorkStep& step) {
            end();
            bar_.emplace(step);
          },
          [this](int done, int total) {
            if (bar_) bar_->show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
          }};
}

constexpr int kLookAt = 3, kBroken = 4;
constexpr double kRequestTimeout = 3.0;  // s

struct Options {
  doctor::DoctorSettings doctor;
  bool json = false;
  std::filesystem::path report;
};

/// Sets a flag at SIGINT or SIGTERM.
class Interruption {
 public:
  Interruption() : thread_([this] { watch(); }) {}
  ~Interruption() {
    ended_ = true;
    thread_.join();
  }
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  const std::atomic<bool>& flag() const { return interrupted_; }

 private:
  void watch() {
    while (!ended_ && !interrupted_)
      interrupted_ = signals_.wait(std::chrono::milliseconds(50)).has_value();
  }

  daemon::AwaitedSignals signals_{{SIGINT, SIGTERM}};
  std::atomic<bool> ended_{false}, interrupted_{false};
  std::thread thread_;
};

void print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

doctor::ReportHead reportHead(const Options& options) {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return {host.data(), reportTime(), CARTVO_VERSION, options.doctor.source.string()};
}

void run(const Options& options) {
  checkResultFiles({options.report});
  const doctor::ReportHead head = reportHead(options);
  WorkDisplay display;
  const auto show_area = [&](const doctor::Findings& area) {
    display.end();
    if (!options.json) print(areaText(area));
  };
  const Interruption interruption;
  const doctor::Examination examination =
      examine(options.doctor, {show_area, display.observer()}, interruption.flag());
  display.end();
  print(options.json ? jsonText(findingsJson(head, examination.findings))
                     : countsText(examination.findings) + "\n" + namesText(examination.findings));
  if (!options.report.empty())
    writeResultFile(options.report, htmlReport(head, examination.findings, examination.pictures,
                                               examination.rig ? &*examination.rig : nullptr));
  if (interruption.flag()) throw std::runtime_error("interrupted: not all was checked");
  const doctor::Verdict worst = worstVerdict(examination.findings);
  if (worst == doctor::Verdict::broken) throw ExitCode(kBroken);
  if (worst == doctor::Verdict::look_at) throw ExitCode(kLookAt);
}

}  // namespace

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "doctor");
  const auto options = std::make_shared<Options>();
  doctor::DoctorSettings& settings = options->doctor;
  settings.access.timeout = kRequestTimeout;
  command
      .addOption("SOURCE,--config", settings.source,
                 "cartvod's configuration file, or the folder of a recording or sequence")
      .captureDefault();
  command.addFlag("--json", options->json, "Print the findings as JSON");
  command.addOption("--report", options->report, "File for a report with pictures (one HTML page)");
  command.addOption("--seconds", settings.seconds, "Time for which the streams are measured, s")
      .transform(positiveTimeInSeconds())
      .captureDefault();
  command.addFlag("--streams", settings.streams,
                  "Open streams of its own also while cartvod receives them; a camera may not permit that");
  addWebPageOptions(command, settings.access);
  command.footer(
      "Each line is ok, look at (cartvod works, but worse or not for long), broken (cartvod does not work, "
      "or not\n"
      "safely) or not checked, with what was seen, what is expected and what to do. It changes nothing (only "
      "--https\n"
      "keeps keys of cameras), and does not disturb a running cartvod, whose numbers it uses. As root it can "
      "read the\n"
      "passwords.\n"
      "Exit codes: 0 all that was checked is ok, 1 failure or interrupted, 2 wrong command line, 3 something "
      "to look\n"
      "at, 4 something is broken.\n"
      "Examples:\n"
      "  sudo cartvo doctor\n"
      "  sudo cartvo doctor --report doctor.html\n"
      "  cartvo doctor /var/lib/cartvo/recordings/2026-05-04T10-00-00Z");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
