// The command line of `cartvo benchmark sensitivity`.
#include "tools/benchmark/sensitivity/benchmark_sensitivity.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "common/command_line/parser.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/benchmark/sensitivity/sensitivity_benchmark.hpp"
#include "tools/benchmark/sensitivity/sensitivity_report.hpp"
#include "tools/cartvo/result_files.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

std::vector<std::string> constantNames() {
  std::vector<std::string> names;
  for (const vo::TunedConstant& constant : vo::tunedConstants())
    names.emplace_back(constant.name);
  return names;
}

struct SensitivityOptions {
  BenchmarkOptions common = [] {
    BenchmarkOptions options;
    options.data = "none";
    return options;
  }();
  DriveOptions drives{.worlds = {.tuning_scenarios = {"campus"}, .set = "tuning"}, .seconds = 8.0};
  std::vector<double> offsets_ms{0.0, 25.0};
  std::vector<double> readouts_ms{0.0, 32.0};
  double image_scale = 1.0;
  std::vector<double> bitrates_mbps;
  std::vector<std::string> constants = constantNames();
  double factor = 1.3;
  bool list = false;
};

/// Each drive with each time offset and readout.
std::vector<world::WorldSettings> worldsOf(const SensitivityOptions& options) {
  std::vector<world::WorldSettings> worlds;
  for (const world::WorldSettings& drive : drivesOf(options.drives, options.common.threads)) {
    for (const double offset : options.offsets_ms) {
      for (const double readout : options.readouts_ms) {
        world::WorldSettings& world = worlds.emplace_back(drive);
        world.offset_s = 1e-3 * offset;
        world.left_readout = world.right_readout = 1e-3 * readout;
        world.image_size.width = static_cast<int>(std::lround(options.image_scale * drive.image_size.width));
        world.image_size.height =
            static_cast<int>(std::lround(options.image_scale * drive.image_size.height));
        world.focal_length = options.image_scale * drive.focal_length;
      }
    }
  }
  return worlds;
}

SensitivitySettings settingsOf(const SensitivityOptions& options) {
  SensitivitySettings settings;
  settings.sequences.data = dataFolder(options.common);
  settings.sequences.worlds = worldsOf(options);
  settings.sequences.bitrates_mbps = options.bitrates_mbps;
  settings.sequences.limits = options.common.limits;
  settings.sequences.cache = options.drives.cache;
  settings.odometry.features = options.drives.features;
  settings.constants = options.constants;
  settings.factor = options.factor;
  settings.threads = options.common.threads;
  requireSequences(settings.sequences.data, settings.sequences.worlds);
  return settings;
}

void run(const SensitivityOptions& options) {
  checkResultFiles({options.common.output});
  if (options.list) {
    writeReport(options.common, "constants", constantsJson, constantsTable);
    return;
  }
  const SensitivitySettings settings = settingsOf(options);
  cv::setNumThreads(1);  // each run has one thread
  WorkDisplay display;
  const Sensitivity sensitivity = runSensitivityBenchmark(settings, display.observer());
  writeReport(
      options.common, "sensitivity", [&] { return sensitivityJson(sensitivity); },
      [&](ReportFormat format) {
        return worldSetLine(settings.sequences.worlds) + sensitivityTable(sensitivity, format);
      });
}

void addChanges(Command command, SensitivityOptions& options) {
  command
      .addOption("--constants", options.constants,
                 "Constants to change, one at a time (default: all; see --list)")
      .delimiter(',')
      .unlistedChoices(constantNames())
      .typeName("LIST");
  command
      .addOption("--factor", options.factor,
                 "Each constant is divided and multiplied by this; integers change by at least one. A large\n"
                 "factor takes each to the end of its range, where most rules have no effect")
      .range(1.001, 1e9)
      .captureDefault();
  command.addFlag(
      "--list", options.list,
      "Print all constants and the limits of the product, with units, ranges and\nsources, instead");
}

}  // namespace

void addSensitivityBenchmark(Command benchmark) {
  const Command command =
      benchmark.addSubcommand("sensitivity", "Measure how much the results depend on each tuned constant");
  const auto options = std::make_shared<SensitivityOptions>();
  addBenchmarkOptions(command, options->common);
  addDriveOptions(command, options->drives);
  addChanges(command, *options);
  command.addOption("--offsets-ms", options->offsets_ms, "Time offsets of the right camera, for each drive")
      .delimiter(',')
      .range(-1000.0, 1000.0)
      .typeName("LIST")
      .captureDefault();
  command
      .addOption("--readouts-ms", options->readouts_ms, "Readouts of both cameras, for each drive and offset")
      .delimiter(',')
      .range(-100.0, 100.0)
      .typeName("LIST")
      .captureDefault();
  command
      .addOption("--image-scale", options->image_scale,
                 "Factor on the size of rendered images: 0.5 is four times as fast")
      .range(0.25, 2.0)
      .captureDefault();
  addBitratesOption(command, options->bitrates_mbps, "Also as H.264 at these rates, kbit/s per camera");
  command.footer(
      "Two runs for each constant, --threads at a time. Constants that change the results no more than "
      "chance\n"
      "does, also with a large factor and in all kinds of drives, are not needed. Choose constants on other\n"
      "worlds than those that report the accuracy. cartvo-benchmark(1) defines each number.\n"
      "Examples:\n"
      "  cartvo benchmark sensitivity --list\n"
      "  cartvo benchmark sensitivity --constants stereo.uniqueness,bundle.frames\n"
      "  cartvo benchmark sensitivity --scenarios dusk,low_texture --image-scale 0.5 --factor 100\n"
      "  cartvo benchmark sensitivity --bitrates-kbps 2000 --format markdown --output sensitivity.md");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
