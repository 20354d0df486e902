// The command line of `cartvo benchmark`, and of its subcommands accuracy and thesis.
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "tools/benchmark/accuracy/accuracy_report.hpp"
#include "tools/benchmark/accuracy/benchmark_ablation.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/benchmark/offset/benchmark_offset.hpp"
#include "tools/benchmark/robustness/benchmark_robustness.hpp"
#include "tools/benchmark/shutter/benchmark_shutter.hpp"
#include "tools/benchmark/speed/benchmark_speed.hpp"
#include "tools/benchmark/thesis/thesis_benchmark.hpp"
#include "tools/benchmark/thesis/thesis_report.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/readout_option.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/replay/setting_names.hpp"
#include "tools/simulate/stream/stream_cache.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

struct AccuracyOptions {
  BenchmarkOptions common;
  std::vector<std::string> scenarios{kAllScenarios};
  std::vector<std::uint64_t> seeds{1};
  double seconds = 0.0;  // 0: the default of each scenario
  double offset_ms = 0.0;
  std::string readout_ms = "0";
  std::vector<double> bitrates;
  std::vector<std::string> estimators = estimatorNames();
  int features = vo::OdometrySettings{}.features;
  fs::path cache = simulate::StreamCache::defaultFolder();
  bool quick = false;
};

/// Default length of a scenario, s: the loop with the standstill at its end, 20 s of standing, about 300 m of
/// campus, and something over 100 m of the others.
double secondsOf(world::Scenario scenario) {
  if (scenario == world::Scenario::loop) return 75.0;
  if (scenario == world::Scenario::campus) return 60.0;
  if (scenario == world::Scenario::standing) return 22.0;  // including 2 s before the traffic
  return 40.0;
}

std::vector<world::WorldSettings> worldsOf(const AccuracyOptions& options) {
  const Readouts readouts = parseReadouts(options.readout_ms);
  std::vector<world::WorldSettings> worlds =
      chosenWorlds(options.scenarios, options.seeds, options.common.threads);
  for (world::WorldSettings& world : worlds) {
    world.seconds = options.seconds > 0.0 ? options.seconds : secondsOf(world.scenario);
    world.offset_s = 1e-3 * options.offset_ms;
    world.left_readout = readouts.left;
    world.right_readout = readouts.right;
  }
  return worlds;
}

AccuracySettings settingsOf(const AccuracyOptions& options) {
  AccuracySettings settings;
  settings.data = dataFolder(options.common);
  settings.worlds = worldsOf(options);
  for (const std::string& name : options.estimators) {
    settings.variants.push_back({name, {}});
    settings.variants.back().odometry.estimator = estimatorNamed(name);
    settings.variants.back().odometry.features = options.features;
  }
  settings.bitrates_mbps = options.bitrates;
  settings.cache = options.cache;
  requireSequences(settings.data, settings.worlds);
  return settings;
}

void runAccuracy(const AccuracyOptions& options) {
  checkResultFiles({options.common.output});
  const AccuracySettings settings = settingsOf(options);
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<SequenceAccuracy> accuracies = runAccuracyBenchmark(settings, display.observer());
  const auto json = [&] {
    nlohmann::ordered_json report{{"features", options.features}};
    report.update(accuracyJson(accuracies));
    return report;
  };
  writeReport(options.common, "accuracy", json,
              [&](ReportFormat format) { return accuracyTable(accuracies, format); });
}

void addWorldOptions(CLI::App& command, AccuracyOptions& options) {
  CLI::Option* scenarios = addWorldChoice(command, options.scenarios, options.seeds);
  CLI::Option* seconds =
      command
          .add_option("--seconds", options.seconds,
                      "Length of each drive (default: 75 loop, 60 campus, 22 standing, 40 the others)")
          ->check(CLI::Range(1.0, 3600.0));
  command
      .add_option("--offset-ms", options.offset_ms,
                  "Time offset of the right camera in rendered worlds (positive: exposed later)")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
  addReadoutOption(command, options.readout_ms, "default: 0");
  command
      .add_option("--cache", options.cache,
                  "Folder for rendered worlds (0.4 GB per minute) and encoded streams")
      ->type_name("DIR")
      ->capture_default_str();
  command.add_flag("--quick", options.quick, "Use only the worlds campus and standing, six seconds each")
      ->excludes(scenarios)
      ->excludes(seconds);
}

void addAccuracy(CLI::App& benchmark) {
  CLI::App* command =
      benchmark.add_subcommand("accuracy", "Print one table of errors, consistency and times");
  const auto options = std::make_shared<AccuracyOptions>();
  addBenchmarkOptions(*command, options->common);
  addWorldOptions(*command, *options);
  command->add_option("--estimators", options->estimators, "Estimators to compare")
      ->delimiter(',')
      ->check(CLI::IsMember(estimatorNames()))
      ->type_name("LIST")
      ->capture_default_str();
  command->add_option("--features", options->features, "Target number of features in each left image")
      ->check(CLI::Range(50, 20000))
      ->capture_default_str();
  command
      ->add_option("--bitrates", options->bitrates,
                   "Measure the same images also as H.264 at these rates (Mbit/s per camera),\n"
                   "encoded as by a camera and decoded by the decoder of cartvod")
      ->delimiter(',')
      ->check(CLI::Range(0.05, 200.0))
      ->type_name("LIST");
  command->footer(
      "Runs every real and rendered sequence through the daemon's pipeline, as `cartvo replay` does, and\n"
      "compares with the truth. A world is rendered once, at about 2 pairs per second, and kept in the "
      "cache. "
      "The\n"
      "report explains its columns; cartvo-benchmark(1) defines each number.\n"
      "Examples:\n"
      "  cartvo benchmark accuracy --quick                                a first look, in some minutes\n"
      "  cartvo benchmark accuracy --seeds 1,2 --format markdown          each scenario with two seeds\n"
      "  cartvo benchmark accuracy --scenarios campus --bitrates 2,4,8    the effect of H.264\n"
      "  cartvo benchmark accuracy --data none --scenarios turns --offset-ms 25\n"
      "docs/accuracy.md has the three commands of its table.");
  command->callback([options] {
    if (options->quick) {
      options->scenarios = {"campus", "standing"};
      options->seconds = 6.0;
    }
    runAccuracy(*options);
  });
}

struct ThesisOptions {
  BenchmarkOptions common;
};

void runThesis(const ThesisOptions& options) {
  checkResultFiles({options.common.output});
  ThesisSettings settings;
  settings.data = dataFolder(options.common);
  settings.odometry.estimator = vo::Estimator::thesis;
  settings.threads = options.common.threads;
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const ThesisResults results = runThesisBenchmark(settings, display.observer());
  writeReport(
      options.common, "thesis", [&] { return thesisJson(results); },
      [&](ReportFormat format) { return thesisTables(results, format); });
}

void addThesis(CLI::App& benchmark) {
  CLI::App* command =
      benchmark.add_subcommand("thesis", "Repeat the tables of the thesis beside its own values");
  const auto options = std::make_shared<ThesisOptions>();
  addBenchmarkOptions(*command, options->common);
  command->footer(
      "Table 5-1 (depth regression with and without sub-pixel disparities, against rendered depth), Figures "
      "4-13\n"
      "and 4-14 (feature counts with a fixed and with adaptive thresholds), Table 5-2 (time of each stage "
      "with\n"
      "1,000 and 9,600 features), Tables 5-3 and 5-4 (RMSE of velocity and rates). A dash marks unknown "
      "values "
      "of\n"
      "the thesis.\n"
      "Examples:\n"
      "  cartvo benchmark thesis --data ../shared/data\n"
      "  cartvo benchmark thesis --format json --output thesis.json");
  command->callback([options] { runThesis(*options); });
}

}  // namespace

void addBenchmarkCommand(CLI::App& cartvo) {
  CLI::App* command =
      cartvo.add_subcommand("benchmark", "Measure the odometry on real sequences and rendered worlds");
  command->require_subcommand(1);
  command->footer("'cartvo benchmark SUBCOMMAND --help' describes each of them.");
  addAccuracy(*command);
  addAblationBenchmark(*command);
  addOffsetBenchmark(*command);
  addRobustnessBenchmark(*command);
  addShutterBenchmark(*command);
  addSpeedBenchmark(*command);
  addThesis(*command);
}

}  // namespace cartvo
