// `cartvo camera`: shows, checks and changes the settings of the configured cameras.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "common/command_line/parser.hpp"
#include "tools/camera/access_options.hpp"
#include "tools/camera/actions.hpp"
#include "tools/camera/camera_access.hpp"
#include "tools/camera/camera_report.hpp"
#include "tools/camera/settings_change.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/json_text.hpp"

namespace cartvo {
namespace {

constexpr int kNotAsNeeded = 3;
constexpr int kRebootNeeded = 4;

struct Options {
  AccessOptions access;
  std::vector<std::string> settings;
  bool json = false, verbose = false;
  bool all = false, yes = false, dry_run = false;
  double wait = 0.0;  // s
};

[[noreturn]] void exitWith(int code) {
  std::fflush(stdout);
  throw ExitCode(code);
}

void print(const std::string& text) {
  std::fputs(text.c_str(), stdout);
}

ReportedCamera read(CameraAccess& access) {
  ReportedCamera camera{access.side, access.client->address().url(), std::nullopt, {}};
  try {
    camera.documents = readCamera(*access.client, access.channels);
  } catch (const capture::IsapiError& error) {
    camera.error = error.what();
  } catch (const capture::HttpError& error) {
    camera.error = error.what();
  }
  return camera;
}

ReportedPair readAll(std::vector<CameraAccess>& cameras) {
  ReportedPair pair;
  for (CameraAccess& access : cameras)
    pair.push_back(read(access));
  return pair;
}

bool allRead(const ReportedPair& cameras) {
  return std::all_of(cameras.begin(), cameras.end(),
                     [](const ReportedCamera& camera) { return camera.documents.has_value(); });
}

/// Ends the command with failure if a camera could not be read; the printed report says why.
void requireAllRead(const ReportedPair& cameras) {
  if (!allRead(cameras)) exitWith(EXIT_FAILURE);
}

/// The wish "NAME=VALUE" or "NAME".
Selection selectionOf(const Options& options) {
  Selection selection;
  selection.all = options.all;
  for (const std::string& word : options.settings) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    if (name.empty() || equals + 1 == word.size())
      throw CommandLineError("SETTING", "expected NAME or NAME=VALUE, found '" + word + "'");
    if (equals == std::string::npos) {
      selection.settings[name] = std::nullopt;
    } else {
      selection.settings[name] = word.substr(equals + 1);
    }
  }
  return selection;
}

void show(const Options& options) {
  const daemon::Configuration configuration =
      daemon::readConfiguration(options.access.configuration, daemon::RigKey::optional);
  std::vector<CameraAccess> cameras = openCameras(configuration, options.access);
  const ReportedPair pair = readAll(cameras);
  const OdometryNeeds needs = needsOf(configuration);
  print(options.json ? jsonText(showJson(pair, needs)) : showText(pair, needs));
  requireAllRead(pair);
}

void check(const Options& options) {
  const daemon::Configuration configuration =
      daemon::readConfiguration(options.access.configuration, daemon::RigKey::optional);
  std::vector<CameraAccess> cameras = openCameras(configuration, options.access);
  const ReportedPair pair = readAll(cameras);
  const CheckReport report = checkReport(pair, needsOf(configuration));
  print(options.json ? jsonText(checkJson(report)) : checkText(report, options.verbose));
  requireAllRead(pair);
  if (!report.isGood()) exitWith(kNotAsNeeded);
}

/// Asks the user. Without a terminal nothing is changed.
void requireConsent(const Options& options, const std::string& question) {
  if (options.yes) return;
  if (isatty(STDIN_FILENO) == 0)
    throw std::runtime_error(
        "nothing was changed: standard input is no terminal to ask at; --yes agrees beforehand");
  print(question + " [y/N] ");
  std::fflush(stdout);
  std::string answer;
  std::getline(std::cin, answer);
  if (answer == "y" || answer == "Y" || answer == "yes") return;
  print("nothing was changed\n");
  exitWith(EXIT_FAILURE);
}

/// The error of a camera that failed while it was changed. `untouched`: the camera after it, if any.
std::runtime_error changeError(const CameraAccess& failed, const std::string& failure,
                               const CameraAccess* untouched) {
  std::string text = "the " + failed.side + " camera failed while it was changed: " + failure;
  if (untouched != nullptr) text += "; the " + untouched->side + " camera was not touched";
  return std::runtime_error(text +
                            "; what was changed is printed above; run the same `cartvo camera apply` again "
                            "once that is mended");
}

void printResult(const CameraAccess& access, const ApplyResult& result) {
  for (const ChangeResult& one : result.results) {
    print(access.side + " camera: " + one.change.setting.name + " " +
          (one.is_taken ? "is " + one.change.to : "is not confirmed: " + one.problem) + "\n");
  }
  if (result.needs_reboot)
    print(access.side + " camera: it needs a reboot: cartvo camera reboot --camera " + access.side + "\n");
}

/// Makes the planned changes and prints how each ended, unless that is printed as JSON afterwards. True if a
/// camera needs a reboot.
bool change(std::vector<CameraAccess>& cameras, const Options& options, AppliedChanges& applied) {
  bool needs_reboot = false;
  for (CameraAccess& access : cameras) {
    const std::size_t index = access.side == "right" ? 1 : 0;
    const ApplyResult& result = applied.results[index].emplace(
        applyChanges(*access.client, access.channels, applied.plan->changes[index]));
    if (!options.json) printResult(access, result);
    if (!result.failure.empty())
      throw changeError(access, result.failure, &access == &cameras.back() ? nullptr : &cameras.back());
    needs_reboot = needs_reboot || result.needs_reboot;
  }
  return needs_reboot;
}

/// Plans what is left, and prints it unless that is printed as JSON afterwards. True if all that was selected
/// is as it should be on all cameras.
bool planRest(std::vector<CameraAccess>& cameras, const OdometryNeeds& needs, const Options& options,
              AppliedChanges& applied) {
  const ReportedPair pair = readAll(cameras);
  for (const ReportedCamera& camera : pair) {
    if (!camera.documents)
      throw std::runtime_error("the changes above were made, but what is left is not known: " + camera.error);
  }
  const ChangePlan& rest = applied.rest.emplace(planChanges(pairOf(pair), needs, selectionOf(options)));
  if (rest.isEmpty() && rest.problems[0].empty() && rest.problems[1].empty()) return true;
  if (!options.json) print("left over:\n" + planText(pair, rest));
  return false;
}

/// Makes the planned changes. Ends the command with the exit code of what is left.
void applyPlan(std::vector<CameraAccess>& cameras, const OdometryNeeds& needs, const Options& options,
               AppliedChanges& applied) {
  const auto print_json = [&] {
    if (options.json) print(jsonText(appliedJson(applied)));
  };
  bool needs_reboot = false, is_done = false;
  try {
    needs_reboot = change(cameras, options, applied);
    is_done = planRest(cameras, needs, options, applied);
  } catch (...) {
    print_json();
    throw;
  }
  print_json();
  if (needs_reboot) exitWith(kRebootNeeded);
  if (!is_done) exitWith(kNotAsNeeded);
}

void apply(const Options& options) {
  const Selection selection = selectionOf(options);
  if (!selection.all && selection.settings.empty())
    throw CommandLineError("SETTING", "name at least one setting, or --all");
  if (const std::string problem = nameProblem(selection); !problem.empty())
    throw CommandLineError("SETTING", problem);
  if (options.json && !options.yes && !options.dry_run)
    throw CommandLineError("--json", "asks nothing: add --yes or --dry-run");
  const daemon::Configuration configuration =
      daemon::readConfiguration(options.access.configuration, daemon::RigKey::optional);
  const OdometryNeeds needs = needsOf(configuration);
  std::vector<CameraAccess> cameras = openCameras(configuration, options.access);
  const ReportedPair pair = readAll(cameras);
  for (const ReportedCamera& camera : pair) {
    if (!camera.documents)
      throw std::runtime_error("nothing was changed, because both cameras must end alike: " + camera.error);
  }
  const ChangePlan plan = planChanges(pairOf(pair), needs, selection);
  AppliedChanges applied{&pair, &plan};
  if (!options.json) print(planText(pair, plan));
  const bool has_problems = !plan.problems[0].empty() || !plan.problems[1].empty();
  if (options.dry_run || plan.isEmpty()) {
    if (options.json) print(jsonText(appliedJson(applied)));
    if (has_problems) exitWith(kNotAsNeeded);
    return;
  }
  requireConsent(options, "Change this?");
  applyPlan(cameras, needs, options, applied);
}

/// A camera that was told to reboot.
struct RebootingCamera {
  CameraAccess* access = nullptr;
  bool was_down = false, is_back = false;
};

/// Waits until all cameras that were told to reboot have gone down and answer again. They are asked in turn,
/// so that none goes down and comes back unseen.
void waitForReboots(std::vector<CameraAccess>& cameras, double seconds) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kPause{200};
  std::vector<RebootingCamera> rebooting;
  for (CameraAccess& access : cameras)
    rebooting.push_back({&access});
  const auto is_back = [](const RebootingCamera& camera) { return camera.is_back; };
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (!std::all_of(rebooting.begin(), rebooting.end(), is_back) && Clock::now() < end) {
    for (RebootingCamera& camera : rebooting) {
      if (camera.is_back) continue;
      const bool answers = camera.access->client->answers();
      camera.is_back = camera.was_down && answers;
      camera.was_down = camera.was_down || !answers;
      if (camera.is_back) print("the " + camera.access->side + " camera answers again\n");
    }
    std::this_thread::sleep_for(kPause);
  }
  for (const RebootingCamera& camera : rebooting) {
    if (camera.is_back) continue;
    throw std::runtime_error("the " + camera.access->side + " camera " +
                             (camera.was_down ? "does not answer " : "has not gone down ") +
                             std::to_string(static_cast<int>(seconds)) + " s after it was told to reboot");
  }
}

void reboot(const Options& options) {
  const daemon::Configuration configuration =
      daemon::readConfiguration(options.access.configuration, daemon::RigKey::optional);
  std::vector<CameraAccess> cameras = openCameras(configuration, options.access);
  for (const CameraAccess& access : cameras)
    print(access.side + " camera, " + access.client->address().url() + "\n");
  requireConsent(options, "Reboot? There are no pictures for about a minute.");
  for (CameraAccess& access : cameras) {
    access.client->reboot();
    print("the " + access.side + " camera reboots\n");
  }
  if (options.wait > 0.0) waitForReboots(cameras, options.wait);
}

void addAccessOptions(Command command, const std::shared_ptr<Options>& options) {
  AccessOptions& access = options->access;
  command
      .addOption("--config", access.configuration,
                 "cartvod's configuration file, which names cameras and passwords")
      .captureDefault();
  command.addOption("--camera", access.side, "Which camera")
      .choices({"left", "right", "both"})
      .captureDefault();
  addWebPageOptions(command, access);
  command
      .addOption("--channel", access.channel,
                 "Number of the stream (default: the one of the camera's URL, else 101)")
      .range(101, 9999)
      .typeName("NUMBER");
  command.addOption("--timeout", access.timeout, "Limit for each request, s")
      .range(0.1, 60.0)
      .captureDefault()
      .typeName("SECONDS");
}

Command addAction(Command command, const std::string& name, const std::string& description,
                  void (*work)(const Options&), std::shared_ptr<Options>& options) {
  const Command action = command.addSubcommand(name, description);
  options = std::make_shared<Options>();
  addAccessOptions(action, options);
  action.callback([options, work] { work(*options); });
  return action;
}

void addApply(Command command) {
  std::shared_ptr<Options> options;
  const Command action =
      addAction(command, "apply", "Change settings to what odometry needs", apply, options);
  action.addOption("SETTING", options->settings, "Settings to change: NAME, or NAME=VALUE")
      .typeName("SETTING");
  action.addFlag("--all", options->all,
                 "Change all settings that are not as needed, except picture size and flip");
  action.addFlag("--dry-run", options->dry_run, "Only show the changes");
  action.addFlag("--yes", options->yes, "Do not ask");
  action.addFlag("--json", options->json, "Print plan and results as JSON; needs --yes or --dry-run");
  action.footer(
      "Both cameras end alike. Each change is read back. Exit codes: 0 all is as selected, 1 failure or not "
      "agreed,\n"
      "2 wrong command line, 3 something selected is not as it should be, 4 a camera needs a reboot.");
}

}  // namespace

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "camera");
  command.limitSubcommands(1, 1);
  std::shared_ptr<Options> options;
  addAction(command, "show", "Show what the cameras are and are set to", show, options)
      .addFlag("--json", options->json, "Print JSON");
  Command action =
      addAction(command, "check", "Compare the settings with those that odometry needs", check, options);
  action.addFlag("--json", options->json, "Print JSON");
  action.addFlag("--verbose", options->verbose, "Also print what is good");
  action.footer(
      "Exit codes: 0 all is good, 1 a camera could not be read, 2 wrong command line, 3 a setting is not as "
      "needed.");
  addApply(command);
  action = addAction(command, "reboot", "Reboot the cameras", reboot, options);
  action.addFlag("--yes", options->yes, "Do not ask");
  action
      .addOption("--wait", options->wait,
                 "Wait so long for the cameras to answer again, s (default: do not wait)")
      .range(0.0, 600.0)
      .typeName("SECONDS");
  addDiscoverAction(command);
  addNetworkAction(command);
  command.footer(
      "Examples:\n"
      "  cartvo camera discover\n"
      "  cartvo camera check\n"
      "  cartvo camera apply --all --dry-run\n"
      "  cartvo camera apply wdr frame-rate=18 time-server=192.168.1.10\n"
      "See cartvo-camera(1) for the settings and why they matter.");
}

}  // namespace cartvo
