// Command line of `cartvo-render`.
#include "lab/render/render_options.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/command_line/parser.hpp"
#include "common/image_size.hpp"
#include "common/units.hpp"
#include "tools/cartvo/readout_option.hpp"

namespace cartvo {
namespace {

constexpr double kMaxDrift = 10000.0;  // ppm

std::string wrongScenario(const std::string& name) {
  try {
    world::scenarioFromName(name);
    return {};
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

std::string wrongSize(const std::string& text) {
  return parseImageSize(text) ? "" : "'" + text + "' is not WIDTHxHEIGHT, such as 680x420";
}

void addDriveOptions(Command command, RenderOptions& options) {
  std::string worlds;
  for (const world::Scenario scenario : world::allScenarios())
    worlds += (worlds.empty() ? "" : ", ") + std::string(world::scenarioName(scenario));
  command.addOption("--world", options.world, "The scenario: " + worlds)
      .typeName("NAME")
      .check(wrongScenario)
      .captureDefault();
  command.addOption("--seconds", options.seconds, "Length in seconds; a second takes some ten to render")
      .range(0.05, 36000.0)
      .captureDefault();
  command.addOption("--seed", options.drive.seed, "Seed of the world and its noise").captureDefault();
  command
      .addOption("--liveliness", options.drive.liveliness,
                 "How lively the drive is, from 0 to 1: it weaves, meets kerbs and bumps, accelerates\n"
                 "and brakes briskly (not motorway)")
      .range(0.0, 1.0)
      .captureDefault();
  command
      .addOption("--start-at", options.drive.start_seconds,
                 "Instant of the drive, s, at which the pictures begin (default: 0, at standstill; of\n"
                 "a lively drive: 5, in motion)")
      .range(0.0, 3600.0);
}

void addTimingOptions(Command command, RenderOptions& options) {
  command.addOption("--frame-rate", options.drive.frame_rate, "Frame rate, Hz")
      .range(1.0, 120.0)
      .captureDefault();
  command
      .addOption("--offset-ms", options.offset_ms,
                 "Time offset: right minus left exposure (default: 0 with --offset-drift-ppm; else\n"
                 "the cameras run free, and the offset passes through all values)")
      .range(-1000.0, 1000.0);
  command
      .addOption("--offset-drift-ppm", options.offset_drift_ppm,
                 "Relative excess of the right camera's frame period (default: see --offset-ms)")
      .range(-kMaxDrift, kMaxDrift);
  addReadoutOption(command, options.readout_ms, "default: 32, or 0.96 of a shorter frame period");
}

void addCameraOptions(Command command, RenderOptions& options) {
  command.addOption("--size", options.size, "Size of the images, px; the field of view does not change")
      .typeName("WIDTHxHEIGHT")
      .check(wrongSize)
      .captureDefault();
  addTimingOptions(command, options);
  const Option frequency = command
                               .addOption("--shake-hz", options.drive.shake.frequency,
                                          "Frequency at which the cameras' mount vibrates")
                               .range(0.1, 50.0);
  const Option amplitude =
      command
          .addOption("--shake-degrees", options.shake_degrees,
                     "Amplitude of that vibration in pitch; that in roll is 0.6 of it. The true poses\n"
                     "contain it")
          .range(0.0, 5.0);
  frequency.needs(amplitude);
  amplitude.needs(frequency);
}

/// Offset and readouts.
void setTiming(const RenderOptions& options, world::WorldSettings& settings) {
  constexpr double kUsualReadout = 0.032;  // s, of sensors that run at 30 Hz whatever frame rate is set
  constexpr double kReadoutShare = 0.96;   // of the frame period of a sensor
  const double period = 1.0 / settings.frame_rate;
  settings.left_readout = settings.right_readout = std::min(kUsualReadout, kReadoutShare * period);
  if (!options.readout_ms.empty()) {
    const Readouts readouts = parseReadouts(options.readout_ms);
    settings.left_readout = readouts.left;
    settings.right_readout = readouts.right;
  }
  const bool is_free_running = !options.offset_ms && !options.offset_drift_ppm;
  settings.offset_s = 1e-3 * (is_free_running ? -0.25e3 * period : options.offset_ms.value_or(0.0));
  settings.offset_drift_ppm = is_free_running ? std::min(1e6 * period / settings.seconds, kMaxDrift)
                                              : options.offset_drift_ppm.value_or(0.0);
}

}  // namespace

world::WorldSettings worldSettings(const RenderOptions& options) {
  world::WorldSettings settings = options.drive;
  settings.scenario = world::scenarioFromName(options.world);
  settings.seconds = options.seconds;
  settings.image_size = parseImageSize(options.size).value();
  settings.focal_length *= settings.image_size.width / 680.0;  // same field of view at any size
  settings.shake.amplitude = options.shake_degrees * kRadiansPerDegree;
  setTiming(options, settings);
  return settings;
}

void addRenderOptions(Command command, RenderOptions& options) {
  addDriveOptions(command, options);
  addCameraOptions(command, options);
  command.addOption("--output-dir", options.output, "Folder to write, which must be empty or missing")
      .typeName("DIR")
      .captureDefault();
  command.addFlag("--print-key", options.print_key,
                  "Render nothing: print a text that tells the pictures of one drive from those of another");
}

}  // namespace cartvo
