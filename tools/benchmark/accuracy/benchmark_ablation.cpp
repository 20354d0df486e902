// The command line of `cartvo benchmark ablation`.
#include "tools/benchmark/accuracy/benchmark_ablation.hpp"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "common/command_line/parser.hpp"
#include "tools/benchmark/accuracy/ablation_report.hpp"
#include "tools/benchmark/accuracy/ablation_variants.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/simulate/stream/stream_cache.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

struct AblationOptions {
  BenchmarkOptions common;
  DriveOptions drives{
      .worlds = {.tuning_scenarios = {"campus", "turns", "traffic", "dusk", "standing"}, .set = "tuning"},
      .seconds = 10.0};
  double offset_ms = 0.0;
  std::vector<std::string> variants = ablationNames();
};

AccuracySettings settingsOf(const AblationOptions& options) {
  AccuracySettings settings;
  settings.data = dataFolder(options.common);
  settings.worlds = drivesOf(options.drives, options.common.threads);
  for (world::WorldSettings& world : settings.worlds)
    world.offset_s = 1e-3 * options.offset_ms;
  vo::OdometrySettings full;
  full.features = options.drives.features;
  settings.variants = ablatedVariants(full, options.variants);
  settings.limits = options.common.limits;
  settings.cache = options.drives.cache;
  requireSequences(settings.data, settings.worlds);
  return settings;
}

void run(const AblationOptions& options) {
  checkResultFiles({options.common.output});
  const AccuracySettings settings = settingsOf(options);
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<SequenceAccuracy> accuracies = runAccuracyBenchmark(settings, display.observer());
  const auto json = [&] {
    nlohmann::ordered_json report{{"features", options.drives.features}};
    report.update(ablationJson(accuracies));
    return report;
  };
  writeReport(options.common, "ablation", json, [&](ReportFormat format) {
    return worldSetLine(settings.worlds) + ablationTable(accuracies, format);
  });
}

std::string variantList() {
  std::string list;
  for (const Ablation& ablation : ablations())
    list.append("\n").append(ablation.name).append(": ").append(ablation.description);
  return list;
}

}  // namespace

void addAblationBenchmark(Command benchmark) {
  const Command command =
      benchmark.addSubcommand("ablation", "Measure the effect of each part of the method");
  const auto options = std::make_shared<AblationOptions>();
  addBenchmarkOptions(command, options->common);
  addDriveOptions(command, options->drives);
  command
      .addOption("--offset-ms", options->offset_ms,
                 "Time offset of the right camera in rendered worlds (positive: exposed later)")
      .range(-1000.0, 1000.0)
      .captureDefault();
  command
      .addOption("--variants", options->variants,
                 "Parts to remove or change, one at a time; as-it-is is always measured:" + variantList())
      .delimiter(',')
      .choices(ablationNames())
      .typeName("LIST");
  command.footer(
      "Measures each real and rendered sequence with each variant of the odometry. docs/how-it-works.md "
      "describes the\n"
      "parts of the method; cartvo-benchmark(1) defines each number.\n"
      "Examples:\n"
      "  cartvo benchmark ablation --scenarios none                       real images only: a minute\n"
      "  cartvo benchmark ablation --data none --scenarios traffic --variants two-pairs,not-robust\n"
      "  cartvo benchmark ablation --format markdown                      everything: half an hour of "
      "rendering");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
