// The command line of `cartvo benchmark accuracy`.
#include "tools/benchmark/accuracy/benchmark_accuracy.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "daemon/service/configuration_names.hpp"
#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "tools/benchmark/accuracy/accuracy_report.hpp"
#include "tools/benchmark/accuracy/accuracy_samples.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/cartvo/readout_option.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/simulate/stream/stream_cache.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

struct AccuracyOptions {
  BenchmarkOptions common;
  WorldChoice worlds;
  double seconds = 0.0;  // 0: the default of each scenario
  double offset_ms = 0.0;
  std::string readout_ms = "0";
  std::vector<double> bitrates_mbps;
  std::vector<std::string> estimators = daemon::namesOf(daemon::kEstimators);
  int features = vo::OdometrySettings{}.features;
  fs::path cache = simulate::StreamCache::defaultFolder();
  bool quick = false;
  fs::path list, samples, merge;
  std::size_t only = 0;  // number of the sequence, from 1; 0: all
  std::string given;     // options that select what is measured, as in a shell
};

constexpr const char* kJobOptions = "Jobs";  // group of options that do not change what is measured

/// A word of a shell's command line.
std::string shellWord(const std::string& text) {
  constexpr const char* kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_=+.,/:@%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string word = "'";
  for (const char c : text)
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// The options of the command line that select what is measured.
std::string givenOptions(Command command) {
  std::string text;
  for (const Option option : command.options()) {
    if (option.count() == 0 || option.groupName() == kJobOptions) continue;
    text.append(" ").append(option.name());
    if (option.isFlag()) continue;
    std::string values;
    for (const std::string& value : option.values())
      values += (values.empty() ? "" : ",") + value;
    text.append(" ").append(shellWord(values));
  }
  return text;
}

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
  std::vector<world::WorldSettings> worlds = chosenWorlds(options.worlds, options.common.threads);
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
    settings.variants.back().odometry.estimator = daemon::valueNamed(name, daemon::kEstimators);
    settings.variants.back().odometry.features = options.features;
  }
  settings.bitrates_mbps = options.bitrates_mbps;
  settings.limits = options.common.limits;
  settings.cache = options.cache;
  requireSequences(settings.data, settings.worlds);
  return settings;
}

void printReport(const AccuracyOptions& options, int features,
                 const std::vector<SequenceAccuracy>& accuracies) {
  const auto json = [&] {
    nlohmann::ordered_json report{{"features", features}};
    report.update(accuracyJson(accuracies));
    return report;
  };
  writeReport(options.common, "accuracy", json,
              [&](ReportFormat format) { return accuracyTable(accuracies, format); });
}

/// Prints a command for each sequence.
void listJobs(const AccuracyOptions& options) {
  const std::size_t jobs = sequenceNames(settingsOf(options)).size();
  for (std::size_t job = 1; job <= jobs; ++job)
    std::printf("cartvo benchmark accuracy%s --only %zu --samples %s\n", options.given.c_str(), job,
                shellWord((options.list / (std::to_string(job) + ".json")).string()).c_str());
}

void mergeJobs(const AccuracyOptions& options) {
  const JobSamples merged = mergedSamples(options.merge);
  printReport(options, merged.features, merged.accuracies);
}

void runAccuracy(const AccuracyOptions& options) {
  checkResultFiles({options.common.output, options.samples});
  AccuracySettings settings = settingsOf(options);
  const std::size_t sequences = options.only > 0 ? sequenceNames(settings).size() : 0;
  if (options.only > sequences)
    throw std::runtime_error("--only " + std::to_string(options.only) + ": there are " +
                             std::to_string(sequences) + " sequences");
  if (options.only > 0) settings.only = options.only - 1;
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<SequenceAccuracy> accuracies = runAccuracyBenchmark(settings, display.observer());
  if (options.samples.empty()) {
    printReport(options, options.features, accuracies);
  } else {
    const JobSamples samples{options.only, sequences, options.given, options.features, accuracies};
    writeResultFile(options.samples, toJson(samples).dump() + "\n");
  }
}

/// Options of a benchmark that several computers share.
void addJobOptions(Command command, AccuracyOptions& options) {
  const Option list =
      command
          .addOption("--list", options.list,
                     "Measure nothing: print a command for each sequence, which writes its results to this\n"
                     "folder. The commands are independent and may run on several computers")
          .typeName("DIR");
  const Option merge = command
                           .addOption("--merge", options.merge,
                                      "Measure nothing: print the table of the results in this folder")
                           .typeName("DIR")
                           .existingFolder()
                           .excludes(list);
  const Option only = command.addOption("--only", options.only, "Measure only the sequence of this number")
                          .typeName("NUMBER")
                          .range(1, 1'000'000)
                          .excludes(list)
                          .excludes(merge);
  const Option samples =
      command.addOption("--samples", options.samples, "Write the results to this file for --merge")
          .typeName("FILE")
          .needs(only)
          .excludes(list)
          .excludes(merge);
  for (const Option option : {list, merge, only, samples})
    option.group(kJobOptions);
  for (const char* name : {"--format", "--json", "--output"})
    command.option(name).value().group(kJobOptions);
}

void addWorldOptions(Command command, AccuracyOptions& options) {
  const Option scenarios = addWorldChoice(command, options.worlds);
  const Option seconds =
      command
          .addOption("--seconds", options.seconds,
                     "Length of each drive (default: 75 loop, 60 campus, 22 standing, 40 the others)")
          .range(1.0, 3600.0);
  command
      .addOption("--offset-ms", options.offset_ms,
                 "Time offset of the right camera in rendered worlds (positive: exposed later)")
      .range(-1000.0, 1000.0)
      .captureDefault();
  addReadoutOption(command, options.readout_ms, "default: 0");
  command
      .addOption("--cache-dir", options.cache,
                 "Folder for rendered worlds (0.4 GB per minute) and encoded streams")
      .typeName("DIR")
      .captureDefault();
  command.addFlag("--quick", options.quick, "Use only the worlds campus and standing, six seconds each")
      .excludes(scenarios)
      .excludes("--set")
      .excludes(seconds);
}

}  // namespace

void addAccuracyBenchmark(Command benchmark) {
  const Command command =
      benchmark.addSubcommand("accuracy", "Print one table of errors, consistency and times");
  const auto options = std::make_shared<AccuracyOptions>();
  addBenchmarkOptions(command, options->common);
  addWorldOptions(command, *options);
  command.addOption("--estimators", options->estimators, "Estimators to compare")
      .delimiter(',')
      .choices(daemon::namesOf(daemon::kEstimators))
      .typeName("LIST")
      .captureDefault();
  command.addOption("--features", options->features, "Target number of features in each left image")
      .range(50, 20000)
      .captureDefault();
  addBitratesOption(command, options->bitrates_mbps,
                    "Measure the same images also as H.264 at these rates (kbit/s per camera),\n"
                    "encoded as by a camera and decoded by the decoder of cartvod");
  addJobOptions(command, *options);
  command.footer(
      "Runs every real and rendered sequence through the daemon's pipeline, as `cartvo replay` does, and\n"
      "compares with the truth. A world is rendered once, at about 2 pairs per second, and kept in the "
      "cache. "
      "The\n"
      "report explains its columns; cartvo-benchmark(1) defines each number.\n"
      "Examples:\n"
      "  cartvo benchmark accuracy --quick                                a first look, in some minutes\n"
      "  cartvo benchmark accuracy --set reporting --seconds 8            worlds on which nothing is tuned\n"
      "  cartvo benchmark accuracy --set tuning --seeds 1,2               each scenario with two seeds\n"
      "  cartvo benchmark accuracy --scenarios campus --bitrates-kbps 2000   the effect of H.264\n"
      "  cartvo benchmark accuracy --data none --scenarios turns --offset-ms 25\n"
      "  cartvo benchmark accuracy --seeds 1,2,3 --list results > jobs    a job for each sequence\n"
      "  sh jobs && cartvo benchmark accuracy --merge results             and the table of all of them\n"
      "docs/accuracy.md has the three commands of its table. tools/slurm/run_jobs runs the jobs on many "
      "computers.");
  command.callback([options, command] {
    options->given = givenOptions(command);
    if (options->quick) {
      options->worlds.scenarios = {"campus", "standing"};
      options->seconds = 6.0;
    }
    if (!options->merge.empty()) return mergeJobs(*options);
    if (!options->list.empty()) return listJobs(*options);
    runAccuracy(*options);
  });
}

}  // namespace cartvo
