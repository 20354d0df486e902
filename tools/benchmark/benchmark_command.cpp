// The command line of `cartvo benchmark`, and of its subcommand thesis.
#include <memory>

#include <opencv2/core/utility.hpp>

#include "common/command_line/parser.hpp"
#include "tools/benchmark/accuracy/benchmark_ablation.hpp"
#include "tools/benchmark/accuracy/benchmark_accuracy.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/benchmark/offset/benchmark_offset.hpp"
#include "tools/benchmark/robustness/benchmark_robustness.hpp"
#include "tools/benchmark/sensitivity/benchmark_sensitivity.hpp"
#include "tools/benchmark/shutter/benchmark_shutter.hpp"
#include "tools/benchmark/speed/benchmark_speed.hpp"
#include "tools/benchmark/thesis/thesis_benchmark.hpp"
#include "tools/benchmark/thesis/thesis_report.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/result_files.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

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

void addThesis(Command benchmark) {
  const Command command =
      benchmark.addSubcommand("thesis", "Repeat the tables of the thesis beside its own values");
  const auto options = std::make_shared<ThesisOptions>();
  addBenchmarkOptions(command, options->common);
  command.footer(
      "Table 5-1 (depth regression with and without sub-pixel disparities, against rendered depth), Figures "
      "4-13\n"
      "and 4-14 (feature counts with a fixed and with adaptive thresholds), Table 5-2 (time of each stage "
      "with\n"
      "1,000 and 9,600 features), Tables 5-3 to 5-7 (RMSE of velocity and rates). A dash marks unknown "
      "values "
      "of\n"
      "the thesis.\n"
      "Examples:\n"
      "  cartvo benchmark thesis --data ../shared/data\n"
      "  cartvo benchmark thesis --json --output thesis.json");
  command.callback([options] { runThesis(*options); });
}

}  // namespace

void addBenchmarkCommand(Command cartvo) {
  const Command command =
      cartvo.addSubcommand("benchmark", "Measure the odometry on real sequences and rendered worlds");
  command.limitSubcommands(1, 1);
  command.footer("'cartvo benchmark SUBCOMMAND --help' describes each of them.");
  addAccuracyBenchmark(command);
  addAblationBenchmark(command);
  addOffsetBenchmark(command);
  addRobustnessBenchmark(command);
  addSensitivityBenchmark(command);
  addShutterBenchmark(command);
  addSpeedBenchmark(command);
  addThesis(command);
}

}  // namespace cartvo
