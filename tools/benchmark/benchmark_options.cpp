// Options, checks and output that all subcommands of `cartvo benchmark` share.
#include "tools/benchmark/benchmark_options.hpp"

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include <opencv2/core/version.hpp>

#include "common/atomic_file.hpp"

namespace cartvo {
namespace fs = std::filesystem;
namespace {

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

/// Values of --scenarios: "all", "none" and the names of the scenarios.
std::vector<std::string> scenarioChoices() {
  std::vector<std::string> names{kAllScenarios, kNoScenario};
  for (const world::Scenario scenario : world::allScenarios())
    names.emplace_back(world::scenarioName(scenario));
  return names;
}

/// scenarioChoices as one line of text.
std::string scenarioList() {
  std::string list;
  for (const std::string& name : scenarioChoices())
    list += (list.empty() ? "" : ", ") + name;
  return list;
}

std::vector<world::Scenario> scenariosNamed(const std::vector<std::string>& names) {
  std::vector<world::Scenario> scenarios;
  for (const std::string& name : names) {
    if (name == kNoScenario) continue;
    if (name == kAllScenarios) {
      scenarios.insert(scenarios.end(), world::allScenarios().begin(), world::allScenarios().end());
    } else {
      scenarios.push_back(world::scenarioFromName(name));
    }
  }
  return scenarios;
}

}  // namespace

ReportFormat BenchmarkOptions::reportFormat() const {
  if (format == "json") return ReportFormat::json;
  return format == "markdown" ? ReportFormat::markdown : ReportFormat::text;
}

void addBenchmarkOptions(CLI::App& command, BenchmarkOptions& options) {
  command
      .add_option("--data", options.data,
                  "Folder with real sequences, each an image folder with its poses.txt, or 'none'\n"
                  "(default: $CARTVO_DATA, else ../shared/data)")
      ->type_name("DIR");
  addReportOptions(command, options);
}

void addReportOptions(CLI::App& command, BenchmarkOptions& options) {
  command.add_option("--threads", options.threads, "Threads for rendering and image operations")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command.add_option("--format", options.format, "text, markdown or json")
      ->check(CLI::IsMember({"text", "markdown", "json"}))
      ->type_name("NAME")
      ->capture_default_str();
  command.add_flag_callback(
      "--json", [&options] { options.format = "json"; }, "As --format json");
  command.add_option("--output", options.output, "Write the report to this file instead of the terminal")
      ->type_name("FILE");
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
    report = all.dump(2) + "\n";
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

CLI::Option* addWorldChoice(CLI::App& command, std::vector<std::string>& scenarios,
                            std::vector<std::uint64_t>& seeds) {
  command.add_option("--seeds", seeds, "Seeds of the worlds; each scenario is rendered with each seed")
      ->delimiter(',')
      ->type_name("LIST")
      ->capture_default_str();
  return command.add_option("--scenarios", scenarios, "Rendered drives: " + scenarioList())
      ->delimiter(',')
      ->check(CLI::IsMember(scenarioChoices()))
      ->type_name("LIST")
      ->capture_default_str();
}

std::vector<world::WorldSettings> chosenWorlds(const std::vector<std::string>& scenarios,
                                               const std::vector<std::uint64_t>& seeds, int threads) {
  std::vector<world::WorldSettings> worlds;
  for (const world::Scenario scenario : scenariosNamed(scenarios)) {
    for (const std::uint64_t seed : seeds) {
      world::WorldSettings& world = worlds.emplace_back();
      world.scenario = scenario;
      world.seed = seed;
      world.threads = threads;
    }
  }
  return worlds;
}

void addDriveOptions(CLI::App& command, DriveOptions& options) {
  addWorldChoice(command, options.scenarios, options.seeds);
  command.add_option("--seconds", options.seconds, "Length of each drive")
      ->check(CLI::Range(6.0, 3600.0))
      ->capture_default_str();
  command.add_option("--features", options.features, "Target number of features in each left image")
      ->check(CLI::Range(50, 20000))
      ->capture_default_str();
  command.add_option("--cache-dir,--cache", options.cache, "Folder for rendered worlds (0.4 GB per minute)")
      ->type_name("DIR")
      ->capture_default_str();
}

std::vector<world::WorldSettings> drivesOf(const DriveOptions& options, int threads) {
  std::vector<world::WorldSettings> worlds = chosenWorlds(options.scenarios, options.seeds, threads);
  for (world::WorldSettings& world : worlds) {
    world.seconds = options.seconds;
    world.lead_in_seconds = 0.5;
  }
  return worlds;
}

benchmark::WorkObserver WorkDisplay::observer() {
  return {[this](const std::string& what) {
            bar_.reset();
            std::fprintf(stderr, "%s\n", what.c_str());
            bar_.emplace("pairs");
          },
          [this](int done, int total) {
            if (bar_) bar_->show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
          }};
}

}  // namespace cartvo
