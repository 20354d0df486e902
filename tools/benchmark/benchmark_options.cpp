// Options, checks and output that all subcommands of `cartvo benchmark` share.
#include "tools/benchmark/benchmark_options.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <opencv2/core/version.hpp>

#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "tools/cartvo/alert_limits_option.hpp"
#include "tools/cartvo/json_text.hpp"

namespace cartvo {
namespace fs = std::filesystem;
namespace {

using benchmark::WorldSet;

constexpr const char* kNoData = "none";

fs::path foundData(const fs::path& given) {
  if (given == kNoData) return {};
  if (!given.empty()) return given;
  if (const char* configured = std::getenv("CARTVO_DATA"); configured != nullptr && *configured != '\0')
    return configured;
  fs::path beside = "../shared/data";
  if (fs::is_directory(beside)) return beside;
  std::fputs("cartvo: no real sequences: ../shared/data does not exist; give their folder with --data DIR\n",
             stderr);
  return {};
}

/// Values of --scenarios: "all", "none", the names of the scenarios and those of their lively drives.
std::vector<std::string> driveNames() {
  std::vector<std::string> names{kAllScenarios, kNoScenario};
  world::WorldSettings drive;
  for (const double liveliness : {0.0, 1.0}) {
    for (const world::Scenario scenario : world::allScenarios()) {
      if (liveliness > 0.0 && !world::canBeLively(scenario)) continue;
      drive.scenario = scenario;
      drive.liveliness = liveliness;
      names.push_back(world::driveName(drive));
    }
  }
  return names;
}

std::optional<WorldSet> chosenSet(const WorldChoice& choice) {
  return choice.set.empty() ? std::nullopt : std::optional(benchmark::worldSetNamed(choice.set));
}

/// Throws std::runtime_error if `what` belongs to another set than the chosen one.
void requireSet(const std::optional<WorldSet>& chosen, WorldSet set, const std::string& what) {
  if (!chosen || *chosen == set) return;
  const std::string name(benchmark::worldSetName(set));
  throw std::runtime_error(what + " belongs to the " + name + " set of worlds, not to the " +
                           std::string(benchmark::worldSetName(*chosen)) + " set; give --set " + name);
}

/// The drives of both sets or of one.
std::vector<world::WorldSettings> allDrives(const std::optional<WorldSet>& chosen) {
  std::vector<world::WorldSettings> drives;
  for (const WorldSet set : {WorldSet::tuning, WorldSet::reporting}) {
    if (chosen && *chosen != set) continue;
    const std::vector<world::WorldSettings> all = benchmark::drivesOf(set);
    drives.insert(drives.end(), all.begin(), all.end());
  }
  return drives;
}

std::vector<world::WorldSettings> chosenDrives(const WorldChoice& choice) {
  const std::optional<WorldSet> set = chosenSet(choice);
  std::vector<std::string> names = choice.scenarios;
  if (names.empty())
    names = set == WorldSet::tuning ? choice.tuning_scenarios : std::vector<std::string>{kAllScenarios};
  std::vector<world::WorldSettings> drives;
  for (const std::string& name : names) {
    if (name == kNoScenario) continue;
    if (name == kAllScenarios) {
      const std::vector<world::WorldSettings> all = allDrives(set);
      drives.insert(drives.end(), all.begin(), all.end());
    } else {
      drives.push_back(world::driveFromName(name));
      requireSet(set, benchmark::setOf(drives.back().scenario), "scenario " + name);
    }
  }
  return drives;
}

/// The seeds with which a scenario is rendered.
std::vector<std::uint64_t> seedsOf(const WorldChoice& choice, world::Scenario scenario) {
  for (const std::uint64_t seed : choice.seeds)
    requireSet(chosenSet(choice), benchmark::setOfSeed(seed), "seed " + std::to_string(seed));
  if (!choice.seeds.empty()) return choice.seeds;
  const WorldSet set = benchmark::setOf(scenario);
  if (set == WorldSet::tuning) return choice.tuning_seeds;
  return {benchmark::defaultSeed(set)};
}

template <typename Item>
std::string joined(const std::vector<Item>& items) {
  std::ostringstream text;
  for (const Item& item : items)
    text << (text.tellp() > 0 ? "," : "") << item;
  return text.str();
}

}  // namespace

ReportFormat BenchmarkOptions::reportFormat() const {
  if (json) return ReportFormat::json;
  return format == "markdown" ? ReportFormat::markdown : ReportFormat::text;
}

void addBenchmarkOptions(Command command, BenchmarkOptions& options) {
  command
      .addOption("--data", options.data,
                 "Folder with real sequences, each an image folder with its poses.txt, or 'none'\n"
                 "(default: $CARTVO_DATA, else ../shared/data)")
      .typeName("DIR");
  addReportOptions(command, options);
  addAlertLimitsOption(command, options.limits);
}

void addBitratesOption(Command command, std::vector<double>& bitrates_mbps, const std::string& description) {
  command
      .addListOption(
          "--bitrates-kbps",
          [&bitrates_mbps](const std::vector<double>& bitrates_kbps) {
            bitrates_mbps.clear();
            for (const double bitrate : bitrates_kbps)
              bitrates_mbps.push_back(bitrate / 1000.0);
          },
          description)
      .delimiter(',')
      .range(50.0, 200'000.0)
      .typeName("LIST");
}

void addReportOptions(Command command, BenchmarkOptions& options) {
  command.addOption("--threads", options.threads, "Threads for rendering and image operations")
      .range(1, 64)
      .captureDefault();
  const Option format = command.addOption("--format", options.format, "text or markdown")
                            .choices({"text", "markdown"})
                            .typeName("NAME")
                            .captureDefault();
  command.addFlag("--json", options.json, "Report as JSON, with all numbers").excludes(format);
  command.addOption("--output", options.output, "Write the report to this file instead of the terminal")
      .typeName("FILE");
}

fs::path dataFolder(const BenchmarkOptions& options) {
  fs::path data = foundData(options.data);
  if (!data.empty() && !fs::is_directory(data)) {
    throw std::runtime_error(
        data.string() +
        ": is no folder; --data takes a folder of image folders as cartvo replay reads them, or 'none'");
  }
  return data;
}

void writeReport(const BenchmarkOptions& options, const char* benchmark,
                 const std::function<nlohmann::ordered_json()>& json,
                 const std::function<std::string(ReportFormat)>& text) {
  std::string report;
  if (options.reportFormat() == ReportFormat::json) {
    nlohmann::ordered_json all = {{"benchmark", benchmark},
                                  {"versions", {{"cartvo", CARTVO_VERSION}, {"opencv", CV_VERSION}}},
                                  {"threads", options.threads}};
    all.update(json());
    report = jsonText(all);
  } else {
    report = text(options.reportFormat());
  }
  if (options.output.empty()) {
    std::fputs(report.c_str(), stdout);
  } else {
    writeResultFile(options.output, report);
  }
}

void requireSequences(const fs::path& data, const std::vector<world::WorldSettings>& worlds) {
  if (data.empty() && worlds.empty())
    throw std::runtime_error(
        "nothing to measure: neither real sequences nor scenarios; give --data or --scenarios");
}

Option addWorldChoice(Command command, WorldChoice& choice) {
  command
      .addOption("--set", choice.set,
                 "Set of worlds: those on which numbers of the estimator are chosen (tuning: seeds\n"
                 "below 10), or those that take no part in it and are reported (reporting: other\n"
                 "scenarios, seeds from 10 on)" +
                     std::string(choice.set.empty() ? "\n(default: both)" : ""))
      .choices({"tuning", "reporting"})
      .typeName("NAME")
      .captureDefault();
  command
      .addOption("--seeds", choice.seeds,
                 "Seeds of the worlds; each scenario is rendered with each seed\n(default: " +
                     joined(choice.tuning_seeds) + " tuning, " +
                     std::to_string(benchmark::defaultSeed(WorldSet::reporting)) + " reporting)")
      .delimiter(',')
      .typeName("LIST");
  command
      .addOption("--liveliness", choice.liveliness,
                 "How much the drives named NAME+lively weave, bump, accelerate and brake")
      .range(0.01, 1.0)
      .captureDefault();
  command
      .addOption("--start-at", choice.start_seconds,
                 "Instant of each drive, s, at which the pictures begin (default: 0, at standstill;\n"
                 "lively drives: in motion)")
      .range(0.0, 3600.0);
  return command
      .addOption("--scenarios", choice.scenarios,
                 "Rendered drives; NAME+lively is the lively one of a scenario\n(default: " +
                     joined(choice.tuning_scenarios) + " tuning, all reporting)")
      .delimiter(',')
      .choices(driveNames())
      .typeName("LIST");
}

std::vector<world::WorldSettings> chosenWorlds(const WorldChoice& choice, int threads) {
  std::vector<world::WorldSettings> worlds;
  for (const world::WorldSettings& drive : chosenDrives(choice)) {
    for (const std::uint64_t seed : seedsOf(choice, drive.scenario)) {
      world::WorldSettings& world = worlds.emplace_back(drive);
      world.seed = seed;
      world.threads = threads;
      world.start_seconds = choice.start_seconds;
      if (world.liveliness > 0.0) world.liveliness = choice.liveliness;
    }
  }
  return worlds;
}

std::string worldSetLine(const std::vector<world::WorldSettings>& worlds) {
  std::vector<std::string> names;
  for (const world::WorldSettings& world : worlds) {
    const std::optional<WorldSet> set = benchmark::setOf(world);
    const std::string name(set ? benchmark::worldSetName(*set) : "neither");
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names.empty() ? "" : "Set of the rendered worlds: " + joined(names) + "\n\n";
}

void addDriveOptions(Command command, DriveOptions& options) {
  addWorldChoice(command, options.worlds);
  command.addOption("--seconds", options.seconds, "Length of each drive").range(6.0, 3600.0).captureDefault();
  command.addOption("--features", options.features, "Target number of features in each left image")
      .range(50, 20000)
      .captureDefault();
  command.addOption("--cache-dir", options.cache, "Folder for rendered worlds (0.4 GB per minute)")
      .typeName("DIR")
      .captureDefault();
}

std::vector<world::WorldSettings> drivesOf(const DriveOptions& options, int threads) {
  std::vector<world::WorldSettings> worlds = chosenWorlds(options.worlds, threads);
  for (world::WorldSettings& world : worlds) {
    world.seconds = options.seconds;
    world.lead_in_seconds = 0.5;
  }
  return worlds;
}

}  // namespace cartvo
