// `cartvo benchmark ablation`: what each part of the method buys.
#include "tools/cartvo/benchmark_ablation.hpp"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "tools/benchmark/ablation_report.hpp"
#include "tools/benchmark/ablation_variants.hpp"
#include "tools/cartvo/benchmark_options.hpp"
#include "tools/simulate/stream_cache.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

struct AblationOptions {
  BenchmarkOptions common;
  DriveOptions drives{.scenarios = {"campus", "turns", "traffic", "dusk", "standing"}, .seconds = 10.0};
  double offset_ms = 0.0;
  std::vector<std::string> variants = ablationNames();
};

AccuracySettings settingsOf(const AblationOptions& options) {
  AccuracySettings settings;
  settings.data = dataFolder(options.common);
  settings.worlds = drivesOf(options.drives, options.common.threads);
  for (world::WorldSettings& world : settings.worlds)
    world.offset_s = 1e-3 * options.offset_ms;
  OdometrySettings full;
  full.features = options.drives.features;
  settings.variants = ablatedVariants(full, options.variants);
  settings.cache = options.drives.cache;
  requireSequences(settings.data, settings.worlds);
  return settings;
}

void run(const AblationOptions& options) {
  checkOutput(options.common.output);
  const AccuracySettings settings = settingsOf(options);
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<SequenceAccuracy> accuracies = runAccuracyBenchmark(settings, display.observer());
  const auto json = [&] {
    nlohmann::ordered_json report{{"features", options.drives.features}};
    report.update(ablationJson(accuracies));
    return report;
  };
  handReport(options.common, "ablation", json,
             [&](ReportFormat format) { return ablationTable(accuracies, format); });
}

std::string variantList() {
  std::string list;
  for (const Ablation& ablation : ablations())
    list.append("\n").append(ablation.name).append(": ").append(ablation.what);
  return list;
}

}  // namespace

void addAblationBenchmark(CLI::App& benchmark) {
  CLI::App* command = benchmark.add_subcommand("ablation", "What each part of the method buys");
  const auto options = std::make_shared<AblationOptions>();
  addBenchmarkOptions(*command, options->common);
  addDriveOptions(*command, options->drives);
  command
      ->add_option("--offset-ms", options->offset_ms,
                   "How much later the right camera of the worlds is exposed")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
  command
      ->add_option("--variants", options->variants,
                   "What is left out, one at a time; as-it-is is measured in any case:" + variantList())
      ->delimiter(',')
      ->check(CLI::IsMember(ablationNames()))
      ->type_name("LIST");
  command->footer(
      "Each real and rendered sequence with each variant of the odometry. The table of docs/method.md; "
      "cartvo-benchmark(1)\n"
      "says what each number is.\n"
      "Examples:\n"
      "  cartvo benchmark ablation --scenarios none                       real images only: a minute\n"
      "  cartvo benchmark ablation --data none --scenarios traffic --variants two-pairs,not-robust\n"
      "  cartvo benchmark ablation --format markdown                      all of it: half an hour to render");
  command->callback([options] { run(*options); });
}

}  // namespace cartvo
