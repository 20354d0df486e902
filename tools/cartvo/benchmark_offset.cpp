// `cartvo benchmark offset`: what it costs that the cameras are not exposed at once.
#include "tools/cartvo/benchmark_offset.hpp"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "calib/atomic_file.hpp"
#include "tools/benchmark/offset_benchmark.hpp"
#include "tools/benchmark/offset_plot.hpp"
#include "tools/benchmark/offset_report.hpp"
#include "tools/cartvo/benchmark_options.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

struct OffsetOptions {
  BenchmarkOptions common;
  DriveOptions drives{.scenarios = {"campus", "turns", "bumpy", "traffic"}};
  std::vector<double> offsets_ms{0.0, 2.0, 5.0, 10.0, 15.0, 20.0, 25.0};
  std::vector<std::string> sweeps{"slow", "fast"};
  std::vector<std::string> models = offsetModelNames();
  std::filesystem::path plot;
};

/// Zero first: what is compared with, and its left images serve the others.
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
    throw std::runtime_error("--plot draws rendered worlds, and there is none");
  if (!settings.worlds.empty()) settings.clocks = clocksOf(options, settings.worlds.front());
  for (const std::string& name : options.models)
    settings.models.push_back(offsetModelNamed(name));
  settings.odometry.features = options.drives.features;
  settings.cache = options.drives.cache;
  return settings;
}

void run(const OffsetOptions& options) {
  checkOutput(options.common.output);
  checkOutput(options.plot);
  const OffsetSettings settings = settingsOf(options);
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<OffsetAccuracy> accuracies = runOffsetBenchmark(settings, display.observer());
  if (!options.plot.empty()) writeFileAtomically(options.plot, offsetPlot(accuracies));
  const auto json = [&] {
    nlohmann::ordered_json report{{"features", options.drives.features}, {"seconds", options.drives.seconds}};
    report.update(offsetJson(accuracies));
    return report;
  };
  handReport(options.common, "offset", json,
             [&](ReportFormat format) { return offsetTable(accuracies, format); });
}

void addClockOptions(CLI::App& command, OffsetOptions& options) {
  command
      .add_option("--offsets-ms", options.offsets_ms,
                  "How much later the right camera is exposed; 0 is measured in any case")
      ->delimiter(',')
      ->check(CLI::Range(-1000.0, 1000.0))
      ->type_name("LIST")
      ->capture_default_str();
  command
      .add_option(
          "--sweeps", options.sweeps,
          "Clocks that drift: slow (50 ppm, across half a frame period, where partners change), fast\n"
          "(through all offsets within the drive), none")
      ->delimiter(',')
      ->check(CLI::IsMember({"slow", "fast", "none"}))
      ->type_name("LIST")
      ->capture_default_str();
}

}  // namespace

void addOffsetBenchmark(CLI::App& benchmark) {
  CLI::App* command =
      benchmark.add_subcommand("offset", "Errors over the time between the cameras' exposures");
  const auto options = std::make_shared<OffsetOptions>();
  addBenchmarkOptions(*command, options->common);
  addDriveOptions(*command, options->drives);
  addClockOptions(*command, *options);
  command
      ->add_option(
          "--models", options->models,
          "two-instants: as cartvod does it; simultaneous: with the left instant for both images, as other\n"
          "odometries do it")
      ->delimiter(',')
      ->check(CLI::IsMember(offsetModelNames()))
      ->type_name("LIST")
      ->capture_default_str();
  command->add_option("--plot", options->plot, "Draw errors over offsets into this SVG")->type_name("FILE");
  command->footer(
      "Each rendered drive with the right camera later and later, and by clocks that drift; of the left "
      "camera,\n"
      "which sees the same each time, the images are rendered once. Real sequences at half their rate: left "
      "images\n"
      "of even numbers with right ones of even and of odd numbers. docs/unsynchronised-cameras.md tells what "
      "it is about.\n"
      "Examples:\n"
      "  cartvo benchmark offset --data none --scenarios campus --seconds 10 --offsets-ms 25 --sweeps none\n"
      "  cartvo benchmark offset --scenarios none                          real images only: seconds\n"
      "  cartvo benchmark offset --format markdown --plot offset.svg       all of it: hours of rendering");
  command->callback([options] { run(*options); });
}

}  // namespace cartvo
