// The command line of `cartvo benchmark offset`.
#include "tools/benchmark/offset/benchmark_offset.hpp"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "common/command_line/parser.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/benchmark/offset/offset_benchmark.hpp"
#include "tools/benchmark/offset/offset_plot.hpp"
#include "tools/benchmark/offset/offset_report.hpp"
#include "tools/cartvo/result_files.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

struct OffsetOptions {
  BenchmarkOptions common;
  DriveOptions drives{
      .worlds = {.tuning_scenarios = {"campus", "turns", "bumpy", "traffic"}, .set = "tuning"}};
  std::vector<double> offsets_ms{0.0, 2.0, 5.0, 10.0, 15.0, 20.0, 25.0};
  std::vector<std::string> sweeps{"slow", "fast"};
  std::vector<std::string> models = offsetModelNames();
  std::filesystem::path plot;
};

/// The clocks to measure. The offset 0 comes first: it is the reference, and the others use its left images.
std::vector<RightClock> clocksOf(const OffsetOptions& options, const world::WorldSettings& world) {
  std::vector<RightClock> clocks{RightClock{}};
  for (const double offset_ms : options.offsets_ms)
    if (offset_ms != 0.0) clocks.push_back({1e-3 * offset_ms, 0.0});
  for (const std::string& sweep : options.sweeps) {
    if (sweep == "slow") clocks.push_back(slowSweep(world));
    if (sweep == "fast") clocks.push_back(fastSweep(world));
  }
  return clocks;
}

OffsetSettings settingsOf(const OffsetOptions& options) {
  OffsetSettings settings;
  settings.data = dataFolder(options.common);
  settings.worlds = drivesOf(options.drives, options.common.threads);
  requireSequences(settings.data, settings.worlds);
  if (settings.worlds.empty() && !options.plot.empty())
    throw std::runtime_error("--plot draws rendered worlds, but none is selected; add --scenarios");
  if (!settings.worlds.empty()) settings.clocks = clocksOf(options, settings.worlds.front());
  for (const std::string& name : options.models)
    settings.models.push_back(offsetModelNamed(name));
  settings.odometry.features = options.drives.features;
  settings.limits = options.common.limits;
  settings.cache = options.drives.cache;
  return settings;
}

void run(const OffsetOptions& options) {
  checkResultFiles({options.common.output, options.plot});
  const OffsetSettings settings = settingsOf(options);
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<OffsetAccuracy> accuracies = runOffsetBenchmark(settings, display.observer());
  if (!options.plot.empty()) writeDrawing(options.plot, offsetPlot(accuracies));
  const auto json = [&] {
    nlohmann::ordered_json report{{"features", options.drives.features}, {"seconds", options.drives.seconds}};
    report.update(offsetJson(accuracies));
    return report;
  };
  writeReport(options.common, "offset", json, [&](ReportFormat format) {
    return worldSetLine(settings.worlds) + offsetTable(accuracies, format);
  });
}

void addClockOptions(Command command, OffsetOptions& options) {
  command
      .addOption("--offsets-ms", options.offsets_ms,
                 "Time offsets of the right camera (positive: exposed later); 0 is always measured")
      .delimiter(',')
      .range(-1000.0, 1000.0)
      .typeName("LIST")
      .captureDefault();
  command
      .addOption("--sweeps", options.sweeps,
                 "Drifting clocks: slow (50 ppm, across half a frame period, partners are kept), fast\n"
                 "(through all offsets within the drive), none")
      .delimiter(',')
      .choices({"slow", "fast", "none"})
      .typeName("LIST")
      .captureDefault();
}

}  // namespace

void addOffsetBenchmark(Command benchmark) {
  const Command command =
      benchmark.addSubcommand("offset", "Measure errors over the time offset between the cameras");
  const auto options = std::make_shared<OffsetOptions>();
  addBenchmarkOptions(command, options->common);
  addDriveOptions(command, options->drives);
  addClockOptions(command, *options);
  command
      .addOption(
          "--models", options->models,
          "two-instants: both exposure instants, as in cartvod; simultaneous: the left instant for both\n"
          "images, as in other odometries")
      .delimiter(',')
      .choices(offsetModelNames())
      .typeName("LIST")
      .captureDefault();
  addPlotOption(command, options->plot, "errors over offsets");
  command.footer(
      "Measures each rendered drive with each time offset of the right camera, and with drifting clocks. The "
      "images of\n"
      "the left camera do not depend on the offset and are rendered once. Real sequences are used at half "
      "their rate:\n"
      "left images of even numbers with right images of even and of odd numbers. docs/accuracy.md has "
      "results.\n"
      "Examples:\n"
      "  cartvo benchmark offset --data none --scenarios campus --seconds 10 --offsets-ms 25 --sweeps none\n"
      "  cartvo benchmark offset --scenarios none                          real images only: seconds\n"
      "  cartvo benchmark offset --format markdown --plot offset.svg       everything: hours of rendering");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
