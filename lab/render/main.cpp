// `cartvo-render`: renders one drive into a folder: the images of two cameras, and their true motion.
// Exit codes: 0 success, 1 failure, 2 wrong command line.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/command_line/command_line.hpp"
#include "common/command_line/parser.hpp"
#include "common/command_line/standard_output.hpp"
#include "common/image_size.hpp"
#include "common/units.hpp"
#include "lab/render/rendered_world.hpp"
#include "lab/render/world_settings.hpp"
#include "tools/cartvo/interruption.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/readout_option.hpp"
#include "tools/simulate/content_files.hpp"

namespace cartvo {
namespace {

/// Command-line options of `cartvo-render`.
struct RenderOptions {
  std::string world = "campus";
  double seconds = 6.0;  ///< about two pairs a second are rendered on two cores
  world::WorldSettings drive;
  std::string size = "680x420";
  std::optional<double> offset_ms;         ///< empty: see worldSettings
  std::optional<double> offset_drift_ppm;  ///< empty: see worldSettings
  std::string readout_ms;                  ///< empty: see worldSettings
  double shake_degrees = 0.0;
  std::filesystem::path output = "drive";
  bool print_key = false;
};

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

/// The settings of the options. By default cameras are as users' cameras: they run free, such that the
/// offset passes through a whole frame period from minus a quarter of it (through as much as 10000 ppm permit
/// in a short drive), and read their rows in 32 ms, or in 0.96 of a shorter frame period. If one of offset
/// and drift is given, the other is 0.
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

/// Adds the options to `command`; `options` must outlive it.
void addRenderOptions(Command command, RenderOptions& options) {
  addDriveOptions(command, options);
  addCameraOptions(command, options);
  command.addOption("--output-dir", options.output, "Folder to write, which must be empty or missing")
      .typeName("DIR")
      .captureDefault();
  command.addFlag("--print-key", options.print_key,
                  "Render nothing: print a text that tells the pictures of one drive from those of another");
}

}  // namespace
}  // namespace cartvo

namespace {

constexpr int kWrongCommandLine = 2;

void describe(cartvo::Command command, cartvo::RenderOptions& options) {
  command.addVersionFlag("-V,--version", "cartvo-render " CARTVO_VERSION);
  cartvo::addRenderOptions(command, options);
  command.footer(
      "The folder then holds image_0 and image_1 (PNG), times_0.txt, times_1.txt, rig.yaml, poses.txt and "
      "truth.tum,\n"
      "as 'cartvo replay' and 'cartvo simulate --sequence' read them. The same options give the same bytes.\n"
      "By default the cameras are as users have them: wide lenses, rolling shutters, free-running clocks.\n"
      "Example:\n"
      "  cartvo-render --world turns --seconds 20 --output-dir turns");
  cartvo::refuseUnusableValues(command);
}

void render(const cartvo::RenderOptions& options) {
  const cartvo::world::RenderedWorld world(worldSettings(options));
  if (options.print_key) {
    std::printf("%s\n", world.cacheKey().c_str());
    return;
  }
  const cartvo::Interruption interruption;
  cartvo::ProgressBar bar("pairs");
  cartvo::simulate::renderFolder(options.output, world, [&](int done, int total) {
    interruption.check();
    bar.show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
  });
  std::printf("%d pairs: %s\n", world.pairCount(), options.output.c_str());
}

/// Returns the exit code.
int run(cartvo::Program& program, const std::vector<std::string>& arguments,
        const cartvo::RenderOptions& options) {
  try {
    if (program.parse(arguments)) render(options);
  } catch (const cartvo::ExitCode& end) {
    return end.code();
  } catch (const cartvo::CommandLineError& error) {
    std::fputs(cartvo::commandLineError(program.command(), error).c_str(), stderr);
    return kWrongCommandLine;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cartvo-render: %s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): running out of memory during start-up may end the program
int main(int argument_count, char** arguments) {
  cartvo::occupyStandardDescriptors();
  cartvo::Program program("cartvo-render", "Renders a drive as two cameras see it, with its true motion");
  cartvo::RenderOptions options;
  describe(program.command(), options);
  const int code =
      run(program, {arguments + std::min(1, argument_count), arguments + argument_count}, options);
  const std::string error = cartvo::standardOutputError();
  if (!error.empty()) std::fprintf(stderr, "cartvo-render: %s\n", error.c_str());
  return code == EXIT_SUCCESS && !error.empty() ? EXIT_FAILURE : code;
}
