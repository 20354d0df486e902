// `cartvo benchmark`: how accurate the odometry is, over all sequences at hand, and the thesis' own tables.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <opencv2/core/version.hpp>

#include "calib/atomic_file.hpp"
#include "tools/benchmark/accuracy_benchmark.hpp"
#include "tools/benchmark/accuracy_report.hpp"
#include "tools/benchmark/table.hpp"
#include "tools/benchmark/thesis_benchmark.hpp"
#include "tools/benchmark/thesis_report.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/replay/estimator_names.hpp"
#include "tools/simulate/stream_cache.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

constexpr const char* kAll = "all";
constexpr const char* kNone = "none";

struct CommonOptions {
  fs::path data;
  int threads = 2;
  std::string format = "text";
  fs::path output;

  ReportFormat reportFormat() const {
    return format == "json" ? ReportFormat::json
                            : (format == "markdown" ? ReportFormat::markdown : ReportFormat::text);
  }
};

struct AccuracyOptions {
  CommonOptions common;
  std::vector<std::string> scenarios{kAll};
  std::vector<std::uint64_t> seeds{1};
  double seconds = 0.0;  // 0: each scenario's own
  double offset_ms = 0.0;
  std::vector<double> bitrates;
  std::vector<std::string> estimators = estimatorNames();
  int features = OdometrySettings{}.features;
  fs::path cache = simulate::StreamCache::defaultFolder();
  bool quick = false;
};

/// Long enough for what a scenario is about: the lap with the stand at its end, twenty seconds of standing,
/// some 300 m of campus, the rest something over 100 m.
double secondsOf(world::Scenario scenario) {
  if (scenario == world::Scenario::loop) return 75.0;
  if (scenario == world::Scenario::campus) return 60.0;
  if (scenario == world::Scenario::standing) return 22.0;  // two of them before the traffic
  return 40.0;
}

/// --data, else $CARTVO_DATA, else ../shared/data if it is there.
fs::path dataFolder(const fs::path& given) {
  if (given == kNone) return {};
  if (!given.empty()) return given;
  if (const char* configured = std::getenv("CARTVO_DATA"); configured != nullptr && *configured != '\0')
    return configured;
  fs::path beside = "../shared/data";
  if (fs::is_directory(beside)) return beside;
  std::fputs("cartvo: no real sequences: ../shared/data is not here; name their folder with --data DIR\n",
             stderr);
  return {};
}

void checkData(const fs::path& data) {
  if (!data.empty() && !fs::is_directory(data)) {
    throw std::runtime_error(
        data.string() +
        ": is no folder; --data takes one with image folders (KITTI or EuRoC layout), or "
        "'none'");
  }
}

std::vector<world::WorldSettings> worldsOf(const AccuracyOptions& options) {
  std::vector<world::Scenario> scenarios;
  for (const std::string& name : options.scenarios) {
    if (name == kNone) continue;
    if (name == kAll) {
      scenarios.insert(scenarios.end(), world::allScenarios().begin(), world::allScenarios().end());
    } else {
      scenarios.push_back(world::scenarioFromName(name));
    }
  }
  std::vector<world::WorldSettings> worlds;
  for (const world::Scenario scenario : scenarios) {
    for (const std::uint64_t seed : options.seeds) {
      world::WorldSettings settings;
      settings.scenario = scenario;
      settings.seed = seed;
      settings.seconds = options.seconds > 0.0 ? options.seconds : secondsOf(scenario);
      settings.offset_s = 1e-3 * options.offset_ms;
      settings.threads = options.common.threads;
      worlds.push_back(settings);
    }
  }
  return worlds;
}

AccuracySettings settingsOf(const AccuracyOptions& options) {
  AccuracySettings settings;
  settings.data = dataFolder(options.common.data);
  checkData(settings.data);
  settings.worlds = worldsOf(options);
  for (const std::string& name : options.estimators)
    settings.estimators.push_back(estimatorNamed(name));
  settings.odometry.features = options.features;
  settings.bitrates_mbps = options.bitrates;
  settings.cache = options.cache;
  if (settings.data.empty() && settings.worlds.empty())
    throw std::runtime_error("there is nothing to measure: neither real sequences nor scenarios");
  return settings;
}

/// A line on the error output for each piece of work, and a bar below it while it goes on.
class WorkDisplay {
 public:
  WorkObserver observer() {
    return {[this](const std::string& what) {
              bar_.reset();
              std::fprintf(stderr, "%s\n", what.c_str());
              bar_.emplace("pairs");
            },
            [this](int done, int total) {
              if (bar_) bar_->show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
            }};
  }

 private:
  std::optional<ProgressBar> bar_;
};

void checkOutput(const CommonOptions& options) {
  if (options.output.empty()) return;
  const fs::path folder = fs::absolute(options.output).parent_path();
  if (!fs::is_directory(folder))
    throw std::runtime_error(options.output.string() + ": cannot be written: there is no folder " +
                             folder.string());
}

void hand(const CommonOptions& options, const std::string& report) {
  if (options.output.empty()) {
    std::fputs(report.c_str(), stdout);
  } else {
    writeFileAtomically(options.output, report);
  }
}

nlohmann::ordered_json jsonHead(const char* benchmark, int threads) {
  return {{"benchmark", benchmark},
          {"versions", {{"cartvo", CARTVO_VERSION}, {"opencv", CV_VERSION}}},
          {"threads", threads}};
}

void runAccuracy(const AccuracyOptions& options) {
  checkOutput(options.common);
  const AccuracySettings settings = settingsOf(options);
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<SequenceAccuracy> accuracies = runAccuracyBenchmark(settings, display.observer());
  if (options.common.reportFormat() == ReportFormat::json) {
    nlohmann::ordered_json json = jsonHead("accuracy", options.common.threads);
    json["features"] = options.features;
    json.update(accuracyJson(accuracies));
    hand(options.common, json.dump(2) + "\n");
  } else {
    hand(options.common, accuracyTable(accuracies, options.common.reportFormat()));
  }
}

void addCommonOptions(CLI::App& command, CommonOptions& options) {
  command
      .add_option("--data", options.data,
                  "Folder with real sequences, each an image folder with its poses.txt, or 'none'\n"
                  "(default: $CARTVO_DATA, else ../shared/data)")
      ->type_name("DIR");
  command.add_option("--threads", options.threads, "Threads for rendering and image operations")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command.add_option("--format", options.format, "text, markdown or json")
      ->check(CLI::IsMember({"text", "markdown", "json"}))
      ->type_name("NAME")
      ->capture_default_str();
  command.add_option("--output", options.output, "Write the report into this file, not to the terminal")
      ->type_name("FILE");
}

std::vector<std::string> scenarioChoices() {
  std::vector<std::string> names{kAll, kNone};
  for (const world::Scenario scenario : world::allScenarios())
    names.emplace_back(world::scenarioName(scenario));
  return names;
}

void addWorldOptions(CLI::App& command, AccuracyOptions& options) {
  std::string choices;
  for (const std::string& name : scenarioChoices())
    choices += (choices.empty() ? "" : ", ") + name;
  CLI::Option* scenarios =
      command.add_option("--scenarios", options.scenarios, "Rendered drives: " + choices)
          ->delimiter(',')
          ->check(CLI::IsMember(scenarioChoices()))
          ->type_name("LIST")
          ->capture_default_str();
  command
      .add_option("--seeds", options.seeds, "Another seed, another world: each scenario with each of them")
      ->delimiter(',')
      ->type_name("LIST")
      ->capture_default_str();
  CLI::Option* seconds =
      command
          .add_option("--seconds", options.seconds,
                      "Length of each drive (default: 75 loop, 60 campus, 22 standing, 40 the others)")
          ->check(CLI::Range(1.0, 3600.0));
  command
      .add_option("--offset-ms", options.offset_ms,
                  "How much later the right camera of the worlds is exposed")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
  command.add_option("--cache", options.cache, "Keeps rendered worlds (0.4 GB a minute) and encoded streams")
      ->type_name("DIR")
      ->capture_default_str();
  command.add_flag("--quick", options.quick, "Of the worlds only campus and standing, six seconds each")
      ->excludes(scenarios)
      ->excludes(seconds);
}

void addAccuracy(CLI::App& benchmark) {
  CLI::App* command = benchmark.add_subcommand("accuracy", "One table of errors, consistency and times");
  const auto options = std::make_shared<AccuracyOptions>();
  addCommonOptions(*command, options->common);
  addWorldOptions(*command, *options);
  command->add_option("--estimators", options->estimators, "Which to compare")
      ->delimiter(',')
      ->check(CLI::IsMember(estimatorNames()))
      ->type_name("LIST")
      ->capture_default_str();
  command->add_option("--features", options->features, "Features aimed at in each left image")
      ->check(CLI::Range(50, 20000))
      ->capture_default_str();
  command
      ->add_option("--bitrates", options->bitrates,
                   "Measure the same pictures as H.264 of these rates too (Mbit/s, each camera's),\n"
                   "encoded as a camera does and decoded by cartvod's decoder")
      ->delimiter(',')
      ->check(CLI::Range(0.05, 200.0))
      ->type_name("LIST");
  command->footer(
      "Runs every real and rendered sequence through the daemon's pipeline, as `cartvo replay` does, and\n"
      "compares with the truth. A world is rendered once, at some 2 pairs a second, and kept in the cache. "
      "The\n"
      "report explains its columns; cartvo-benchmark(1) says exactly what each number is.\n"
      "Examples:\n"
      "  cartvo benchmark accuracy --quick                                a first look, in some minutes\n"
      "  cartvo benchmark accuracy --seeds 1,2 --format markdown          the table of docs/accuracy.md\n"
      "  cartvo benchmark accuracy --scenarios campus --bitrates 2,4,8    what H.264 costs\n"
      "  cartvo benchmark accuracy --data none --scenarios turns --offset-ms 25");
  command->callback([options] {
    if (options->quick) {
      options->scenarios = {"campus", "standing"};
      options->seconds = 6.0;
    }
    runAccuracy(*options);
  });
}

struct ThesisOptions {
  CommonOptions common;
};

void runThesis(const ThesisOptions& options) {
  checkOutput(options.common);
  ThesisSettings settings;
  settings.data = dataFolder(options.common.data);
  checkData(settings.data);
  settings.odometry.estimator = Estimator::thesis;
  settings.threads = options.common.threads;
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const ThesisResults results = runThesisBenchmark(settings, display.observer());
  if (options.common.reportFormat() == ReportFormat::json) {
    nlohmann::ordered_json json = jsonHead("thesis", options.common.threads);
    json.update(thesisJson(results));
    hand(options.common, json.dump(2) + "\n");
  } else {
    hand(options.common, thesisTables(results, options.common.reportFormat()));
  }
}

void addThesis(CLI::App& benchmark) {
  CLI::App* command =
      benchmark.add_subcommand("thesis", "The thesis' tables, repeated beside its own values");
  const auto options = std::make_shared<ThesisOptions>();
  addCommonOptions(*command, options->common);
  command->footer(
      "Table 5-1 (depth regression with and without sub-pixel disparities, against rendered depth), Figures "
      "4-13\n"
      "and 4-14 (feature counts with a fixed and with adaptive thresholds), Table 5-2 (time of each stage "
      "with\n"
      "1,000 and 9,600 features), Tables 5-3 and 5-4 (RMSE of velocity and rates). Values of the thesis that "
      "are\n"
      "not known stand as a dash.\n"
      "Examples:\n"
      "  cartvo benchmark thesis --data ../shared/data\n"
      "  cartvo benchmark thesis --format json --output thesis.json");
  command->callback([options] { runThesis(*options); });
}

}  // namespace

void addBenchmarkCommand(CLI::App& cartvo) {
  CLI::App* command = cartvo.add_subcommand("benchmark", "Measure the odometry on all sequences at hand");
  command->require_subcommand(1);
  command->footer("'cartvo benchmark accuracy --help' explains each.");
  addAccuracy(*command);
  addThesis(*command);
}

}  // namespace cartvo
