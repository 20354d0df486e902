// cartvod: reads two cameras and publishes the cart's motion over LCM until SIGTERM.
// Exit codes: 0 stopped cleanly, 1 failed, 2 wrong command line or configuration.

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "common/command_line/bash_completion.hpp"
#include "common/command_line/command_line.hpp"
#include "common/command_line/parser.hpp"
#include "common/command_line/standard_output.hpp"
#include "daemon/diagnostics/journal.hpp"
#include "daemon/diagnostics/log.hpp"
#include "daemon/service/awaited_signals.hpp"
#include "daemon/service/configuration.hpp"
#include "daemon/service/daemon.hpp"
#include "daemon/service/live_recording.hpp"

namespace {

using cartvo::daemon::Configuration;

constexpr int kStopped = 0;
constexpr int kFailed = 1;
constexpr int kWrongConfiguration = 2;

struct CommandLine {
  std::filesystem::path configuration;
  std::filesystem::path recording_directory;
  bool check_only = false;
};

void describe(cartvo::Command program, CommandLine& command_line) {
  program.addVersionFlag("--version", "cartvod " CARTVO_VERSION);
  program.addOption("--config", command_line.configuration, "Configuration file, see cartvod.yaml(5)")
      .required();
  program.addFlag(
      "--check-config", command_line.check_only,
      "Check the configuration, the rig file, the passwords and the recordings' folder, then exit");
  program.addOption("--record", command_line.recording_directory,
                    "Record both streams as received into this folder (overrides recording.directory)");
  cartvo::addBashCompletionFlag(program, "cartvod", "");
}

/// Reads and checks the configuration. `start`: name of this start's recording folder.
Configuration loadConfiguration(const CommandLine& command_line, const std::string& start) {
  Configuration configuration = cartvo::daemon::readConfiguration(command_line.configuration);
  if (!command_line.recording_directory.empty()) {
    // With --record nothing in that folder is deleted to free disk space.
    configuration.recording_directory = std::filesystem::absolute(command_line.recording_directory);
    configuration.recording_start = cartvo::daemon::RecordingStart::automatic;
  } else if (!configuration.recording_directory.empty()) {
    configuration.recording_quota.recordings = configuration.recording_directory;
    configuration.recording_directory /= start;
  }
  cartvo::daemon::checkConfiguration(configuration);
  return configuration;
}

/// Signals of the daemon. In a terminal SIGHUP, which closing it sends, ends the program as it does others.
std::vector<int> signalsToAwait() {
  std::vector<int> signals{SIGTERM, SIGINT};
  if (isatty(STDIN_FILENO) == 0) signals.push_back(SIGHUP);
  return signals;
}

/// Reads the configuration again; a broken one leaves the old one in force.
void reload(const CommandLine& command_line, const std::string& start, cartvo::daemon::Daemon& daemon) {
  try {
    daemon.reload(loadConfiguration(command_line, start));
  } catch (const std::exception& error) {
    cartvo::daemon::logEvent(
        spdlog::level::err,
        std::string("the configuration was not read again, the old one stays in force: ") + error.what(),
        {{"CARTVO_EVENT", "configuration"}});
  }
}

/// Stops the daemon at SIGTERM or SIGINT, reloads at SIGHUP; returns when `end` is requested.
void watchSignals(const std::stop_token& end, const cartvo::daemon::AwaitedSignals& signals,
                  cartvo::daemon::Daemon& daemon, const std::function<void()>& reload_configuration) {
  while (!end.stop_requested()) {
    const std::optional<int> signal = signals.wait(std::chrono::milliseconds(50));
    if (!signal) continue;
    if (*signal == SIGHUP) {
      reload_configuration();
      continue;
    }
    spdlog::info("received {}", *signal == SIGTERM ? "SIGTERM" : "SIGINT");
    daemon.stop();
    return;
  }
}

int run(const CommandLine& command_line) {
  const cartvo::daemon::AwaitedSignals signals(signalsToAwait());
  const std::string start = cartvo::daemon::recordingFolderName();
  Configuration configuration;
  try {
    configuration = loadConfiguration(command_line, start);
  } catch (const std::filesystem::filesystem_error& error) {
    spdlog::error(cartvo::textOf(error));
    return kWrongConfiguration;
  } catch (const std::exception& error) {
    spdlog::error(error.what());
    return kWrongConfiguration;
  }
  if (command_line.check_only) {
    if (const std::string obstacle = cartvo::daemon::recordingObstacle(configuration); !obstacle.empty()) {
      spdlog::error(obstacle);
      return kWrongConfiguration;
    }
    if (const std::string warning = cartvo::daemon::configurationWarning(configuration); !warning.empty())
      std::fprintf(stderr, "%s: warning: %s\n", configuration.rig.c_str(), warning.c_str());
    std::printf("%s: in order\n", command_line.configuration.c_str());
    return kStopped;
  }
  // The odometry goes on if the log is no longer read, as by a program at a pipe that has ended.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    cartvo::daemon::setUpLog(configuration.log_level);
    cartvo::daemon::Daemon daemon(configuration);
    const auto reload_configuration = [&] { reload(command_line, start, daemon); };
    const std::jthread signal_watch(
        [&](const std::stop_token& end) { watchSignals(end, signals, daemon, reload_configuration); });
    daemon.run();
  } catch (const std::bad_alloc&) {
    spdlog::error("out of memory: see MemoryMax of the service, and which program uses the memory");
    return kFailed;
  } catch (const std::system_error& error) {
    const bool is_limit = error.code() == std::errc::resource_unavailable_try_again;
    spdlog::error(
        "{}{}", error.what(),
        is_limit ? ": no thread can be started; raise TasksMax or 'ulimit -u', and the memory" : "");
    return kFailed;
  } catch (const std::exception& error) {
    spdlog::error(error.what());
    return kFailed;
  }
  return kStopped;
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): running out of memory during start-up may end the program
int main(int argument_count, char** arguments) {
  cartvo::occupyStandardDescriptors();
  cartvo::daemon::setUpLog(spdlog::level::info);
  const std::vector<std::string> words(arguments + std::min(1, argument_count), arguments + argument_count);
  cartvo::Program program(
      "cartvod",
      "Turns two cameras' streams into the cart's motion and publishes it over LCM. See cartvod(8).");
  CommandLine command_line;
  describe(program.command(), command_line);
  cartvo::refuseUnusableValues(program.command());
  int code = kStopped;
  try {
    if (const std::string unknown = cartvo::unknownWord(program.command(), words); !unknown.empty())
      throw cartvo::CommandLineError(unknown);
    if (program.parse(words)) code = run(command_line);
  } catch (const cartvo::CommandLineError& error) {
    std::fputs(cartvo::commandLineError(program.command(), error).c_str(), stderr);
    code = kWrongConfiguration;
  }
  const std::string output_error = cartvo::standardOutputError();
  if (!output_error.empty()) spdlog::error(output_error);
  return code == kStopped && !output_error.empty() ? kFailed : code;
}
