// The command line of `cartvo benchmark robustness`.
#include "tools/benchmark/robustness/benchmark_robustness.hpp"

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "common/command_line/parser.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/benchmark/robustness/robustness_benchmark.hpp"
#include "tools/benchmark/robustness/robustness_report.hpp"
#include "tools/cartvo/result_files.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

std::vector<std::string> disturbanceNames() {
  std::vector<std::string> names;
  for (const Disturbance& disturbance : allDisturbances())
    names.push_back(disturbance.name);
  return names;
}

struct RobustnessOptions {
  BenchmarkOptions common;
  // Seeds and length are not those of the accuracy benchmark: there, numbers of the estimator are compared.
  DriveOptions drives{
      .worlds = {.tuning_scenarios = {"campus", "turns", "rough"}, .tuning_seeds = {7}, .set = "tuning"},
      .seconds = 12.0};
  std::vector<std::string> disturbances = disturbanceNames();
  bool quick = false;
};

void run(const RobustnessOptions& options) {
  checkResultFiles({options.common.output});
  RobustnessSettings settings;
  settings.data = dataFolder(options.common);
  settings.worlds = drivesOf(options.drives, options.common.threads);
  requireSequences(settings.data, settings.worlds);
  settings.disturbances = options.disturbances;
  settings.odometry.features = options.drives.features;
  settings.limits = options.common.limits;
  settings.cache = options.drives.cache;
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<RobustnessRow> rows = runRobustnessBenchmark(settings, display.observer());
  writeReport(
      options.common, "robustness",
      [&] {
        nlohmann::ordered_json report{{"features", options.drives.features},
                                      {"seconds", options.drives.seconds}};
        report.update(robustnessJson(rows));
        return report;
      },
      [&](ReportFormat format) { return worldSetLine(settings.worlds) + robustnessTable(rows, format); });
}

std::string disturbanceHelp() {
  std::string help = "What is done to each sequence:";
  for (const Disturbance& disturbance : allDisturbances())
    help += "\n" + disturbance.name + ": " + disturbance.explanation;
  return help;
}

}  // namespace

void addRobustnessBenchmark(Command benchmark) {
  const Command command = benchmark.addSubcommand(
      "robustness", "Compare both estimators on disturbed sequences: lost pairs, text, a wrong rig, ...");
  const auto options = std::make_shared<RobustnessOptions>();
  addBenchmarkOptions(command, options->common);
  addDriveOptions(command, options->drives);
  command.addOption("--disturbances", options->disturbances, disturbanceHelp())
      .delimiter(',')
      .choices(disturbanceNames())
      .typeName("LIST")
      .captureDefault();
  command.addFlag("--quick", options->quick, "Use only the world rough, six seconds of it")
      .excludes("--scenarios")
      .excludes("--set")
      .excludes("--seconds");
  command.footer(
      "Plays every real and rendered sequence as it is and with each disturbance, with `estimator: "
      "reprojection` and with\n"
      "`estimator: thesis`. The last line counts the rows where the default is worse, and its VALID messages "
      "above\n"
      "an alert limit; both should be 0.\n"
      "Examples:\n"
      "  cartvo benchmark robustness --quick                              some minutes\n"
      "  cartvo benchmark robustness --scenarios none                     real images only\n"
      "  cartvo benchmark robustness --data none --disturbances lose30,bursts --format markdown");
  command.callback([options] {
    if (options->quick) {
      options->drives.worlds.scenarios = {"rough"};
      options->drives.seconds = 6.0;
    }
    run(*options);
  });
}

}  // namespace cartvo
