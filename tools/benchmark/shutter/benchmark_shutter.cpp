// The command line of `cartvo benchmark shutter`.
#include "tools/benchmark/shutter/benchmark_shutter.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "common/command_line/parser.hpp"
#include "common/units.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/benchmark/shutter/shutter_benchmark.hpp"
#include "tools/benchmark/shutter/shutter_plot.hpp"
#include "tools/benchmark/shutter/shutter_report.hpp"
#include "tools/cartvo/alert_limits_option.hpp"
#include "tools/cartvo/readout_option.hpp"
#include "tools/cartvo/result_files.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

struct ShutterOptions {
  BenchmarkOptions common;
  DriveOptions drives{
      .worlds = {.tuning_scenarios = {"campus", "turns", "bumpy", "traffic"}, .set = "tuning"}};
  std::vector<std::string> readouts_ms{"0", "16", "32", "38", "-32", "32/38"};
  std::vector<double> offsets_ms{0.0, 25.0};
  bool no_sweep = false;
  std::vector<double> shake_hz{1.0, 3.0, 5.0, 8.0, 12.0};
  double shake_degrees = 0.3;
  std::string shake_readout_ms = "32";
  std::vector<std::string> models = readoutModelNames();
  std::filesystem::path plot;
};

StereoReadout readoutOf(const std::string& milliseconds) {
  std::string text = milliseconds;
  std::replace(text.begin(), text.end(), '/', ',');  // a comma separates the values of a list
  const Readouts parsed = parseReadouts(text);
  return {parsed.left, parsed.right};
}

std::string checkReadout(const std::string& milliseconds) {
  try {
    readoutOf(milliseconds);
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

void addCase(std::vector<ShutterCase>& cases, const ShutterCase& wanted) {
  if (std::find(cases.begin(), cases.end(), wanted) == cases.end()) cases.push_back(wanted);
}

/// The cases to measure. Those of synchronised cameras come before those with an offset, which use their left
/// images, and each rolling shutter after a global one, which is its reference.
std::vector<ShutterCase> casesOf(const ShutterOptions& options, const world::WorldSettings& world) {
  std::vector<RightClock> clocks;
  for (const double offset_ms : options.offsets_ms)
    clocks.push_back({1e-3 * offset_ms, 0.0});
  if (!options.no_sweep) clocks.push_back(fastSweep(world));
  std::vector<ShutterCase> cases;
  for (const RightClock& clock : clocks) {
    for (const std::string& readout : options.readouts_ms)
      addCase(cases, {readoutOf(readout), clock, {}});
  }
  if (options.shake_degrees == 0.0) return cases;
  for (const double frequency : options.shake_hz) {
    const world::Shake shake{frequency, options.shake_degrees * kRadiansPerDegree};
    addCase(cases, {{}, {}, shake});
    addCase(cases, {readoutOf(options.shake_readout_ms), {}, shake});
  }
  return cases;
}

void run(const ShutterOptions& options) {
  checkResultFiles({options.common.output, options.plot});
  ShutterSettings settings;
  settings.worlds = drivesOf(options.drives, options.common.threads);
  if (settings.worlds.empty())
    throw std::runtime_error("nothing to measure: no rendered drive is selected; name some with --scenarios");
  settings.cases = casesOf(options, settings.worlds.front());
  for (const std::string& name : options.models)
    settings.models.push_back(readoutModelNamed(name));
  settings.odometry.features = options.drives.features;
  settings.limits = options.common.limits;
  settings.cache = options.drives.cache;
  cv::setNumThreads(options.common.threads);
  WorkDisplay display;
  const std::vector<ShutterAccuracy> accuracies = runShutterBenchmark(settings, display.observer());
  const auto json = [&] {
    nlohmann::ordered_json report{{"features", options.drives.features}, {"seconds", options.drives.seconds}};
    report.update(shutterJson(accuracies));
    return report;
  };
  writeReport(options.common, "shutter", json, [&](ReportFormat format) {
    return worldSetLine(settings.worlds) + shutterTable(accuracies, format);
  });
  if (!options.plot.empty()) writeDrawing(options.plot, shutterPlot(accuracies));
}

void addShakeOptions(Command command, ShutterOptions& options) {
  command
      .addOption("--shake-hz", options.shake_hz,
                 "Frequencies of a vibration of the cameras' mount, each measured with synchronised\n"
                 "cameras, a global shutter and --shake-readout-ms")
      .delimiter(',')
      .range(0.1, 50.0)
      .typeName("LIST")
      .captureDefault();
  command
      .addOption("--shake-degrees", options.shake_degrees,
                 "Amplitude of the vibration in pitch, 0.6 of it in roll; 0: no shaken drives")
      .range(0.0, 5.0)
      .captureDefault();
  command.addOption("--shake-readout-ms", options.shake_readout_ms, "Readout in shaken drives")
      .check(checkReadout)
      .typeName("BOTH|LEFT/RIGHT")
      .captureDefault();
}

void addShutterOptions(Command command, ShutterOptions& options) {
  command
      .addOption("--readouts-ms", options.readouts_ms,
                 "Readouts: time from the exposure of the upper edge of an image to that of the\n"
                 "lower one, of both cameras, or LEFT/RIGHT; 0 is the reference of the others")
      .delimiter(',')
      .check(checkReadout)
      .typeName("LIST")
      .captureDefault();
  command
      .addOption("--offsets-ms", options.offsets_ms,
                 "Time offsets of the right camera (positive: exposed later)")
      .delimiter(',')
      .range(-1000.0, 1000.0)
      .typeName("LIST")
      .captureDefault();
  command.addFlag("--no-sweep", options.no_sweep,
                  "Leave out the free-running right camera, whose offset passes through all values");
  addShakeOptions(command, options);
  command
      .addOption("--models", options.models,
                 "What the odometry knows. known: the true readout; estimated: 32 ms with 40 %, as of\n"
                 "cameras whose rig file states none; ignored: it assumes a global shutter")
      .delimiter(',')
      .choices(readoutModelNames())
      .typeName("LIST")
      .captureDefault();
}

}  // namespace

void addShutterBenchmark(Command benchmark) {
  const Command command =
      benchmark.addSubcommand("shutter", "Measure errors over the readout of rolling shutters");
  const auto options = std::make_shared<ShutterOptions>();
  addReportOptions(command, options->common);
  addAlertLimitsOption(command, options->common.limits);
  addDriveOptions(command, options->drives);
  addShutterOptions(command, *options);
  addPlotOption(command, options->plot, "errors over readouts and vibrations");
  command.footer(
      "Measures each rendered drive with each readout and time offset, and with a vibration of the cameras' "
      "mount.\n"
      "Each row of a rendered image is taken at its own instant. An image counts at the exposure of its "
      "middle "
      "row.\n"
      "A world is rendered once, in some minutes, and kept in the cache, so the work can be done in parts.\n"
      "Examples:\n"
      "  cartvo benchmark shutter --scenarios turns --readouts-ms 0,32 --offsets-ms 0 --no-sweep "
      "--shake-degrees 0\n"
      "  cartvo benchmark shutter --scenarios campus --readouts-ms 0 --offsets-ms 0 --no-sweep --shake-hz 8\n"
      "  cartvo benchmark shutter --format markdown --plot shutter.svg      everything: hours of rendering");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
