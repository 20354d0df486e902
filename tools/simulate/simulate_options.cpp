// Command-line options of `cartvo simulate`.
#include "tools/simulate/simulate_options.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/command_line/parser.hpp"
#include "common/exact_text.hpp"
#include "tools/simulate/server/camera_pair_simulation.hpp"

namespace cartvo {
namespace {

constexpr double kMaxDrift = 10000.0;  // ppm

/// An option's validator: text for which `parse` throws std::invalid_argument is an error of the command
/// line.
template <typename Parse>
auto validatorFor(Parse parse) {
  return [parse](const std::string& text) -> std::string {
    try {
      parse(text);
      return {};
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
}

/// An option that only cartvo-render reads and checks.
struct RenderingOption {
  const char* name;
  const char* type;
  const char* description;
};

constexpr RenderingOption kRenderingOptions[] = {
    {"--seed", "NUMBER", "Seed of the rendered world and its noise (default: 1)"},
    {"--size", "WIDTHxHEIGHT",
     "Size of the rendered images, px; the field of view does not change (default: 680x420)"},
    {"--liveliness", "NUMBER", "How lively the drive is, from 0 (the default) to 1"},
    {"--start-at", "SECONDS",
     "Instant of the drive at which the pictures begin (default: 0, at standstill; of\n"
     "a lively drive: 5, in motion)"},
    {"--readout-ms", "BOTH|LEFT,RIGHT",
     "Time from the exposure of the upper edge of a rendered image to that of the\n"
     "lower one; 0: a global shutter (default: 32, or 0.96 of a shorter frame period)"},
    {"--shake-hz", "HZ", "Frequency at which the rendered cameras' mount vibrates"},
    {"--shake-degrees", "DEGREES", "Amplitude of that vibration in pitch"},
};

void addRenderingOptions(Command group, SimulateOptions& options, Option sequence) {
  group.addOption("--frame-rate", options.frame_rate, "Frame rate of the rendered cameras, Hz")
      .range(1.0, 120.0)
      .excludes(sequence)
      .captureDefault();
  for (const RenderingOption& option : kRenderingOptions) {
    group.addOption(option.name, options.rendering[option.name], option.description)
        .typeName(option.type)
        .excludes(sequence);
  }
}

void addOffsetOptions(Command group, SimulateOptions& options) {
  group
      .addOption("--offset-ms", options.offset_ms,
                 "Time offset: right minus left exposure. For a sequence only the timestamps\n"
                 "change, not the pictures (default: 0 for a sequence or with\n"
                 "--offset-drift-ppm; else the cameras run free, and the offset passes through\n"
                 "all values)")
      .range(-1000.0, 1000.0);
  group
      .addOption("--offset-drift-ppm", options.offset_drift_ppm,
                 "Relative excess of the right camera's frame period (default: see\n"
                 "--offset-ms)")
      .range(-kMaxDrift, kMaxDrift);
}

/// Returns the group.
Command addContentOptions(Command command, SimulateOptions& options) {
  const auto group = command.addOptionGroup("Content", "What the cameras show");
  const Option world =
      group
          .addOption("--world", options.world,
                     "A drive that cartvo-render renders: campus, turns, traffic, stop_and_go, ...;\n"
                     "'cartvo-render --help' names all, and explains its options that follow here")
          .typeName("NAME")
          .captureDefault();
  const Option sequence = group
                              .addOption("--sequence", options.sequence,
                                         "A recorded image sequence (KITTI or EuRoC layout), at its own rate")
                              .typeName("DIR");
  sequence.excludes(world);
  const Option recording =
      group
          .addOption("--recording", options.recording,
                     "A recording of cartvod in H.264, or a drive by --encode (default: the sample\n"
                     "drive, unless another option of this group is given)")
          .typeName("DIR");
  group
      .addOption("--seconds", options.seconds,
                 "Length in seconds (default: 6 if rendered, or the whole sequence or recording);\n"
                 "a second takes some ten seconds to render, once")
      .range(0.05, 36000.0);
  addOffsetOptions(group, options);
  addRenderingOptions(group, options, sequence);
  for (const Option& option : group.options())
    if (option.name() != recording.name() && option.name() != "--seconds") option.excludes(recording);
  return group;
}

void addCameraOptions(Command command, SimulateOptions& options) {
  const auto group = command.addOptionGroup("Cameras", "How the cameras send it");
  group.addOption("--left-address", options.left_address, "Address of the left camera's RTSP server")
      .typeName("ADDRESS:PORT")
      .check(validatorFor(simulate::parseEndpoint))
      .captureDefault();
  group.addOption("--right-address", options.right_address, "Address of the right camera's RTSP server")
      .typeName("ADDRESS:PORT")
      .check(validatorFor(simulate::parseEndpoint))
      .captureDefault();
  group.addOption("--user", options.user, "User for Digest authentication").captureDefault();
  group
      .addOption("--password-file", options.password_file,
                 "File with the password in its first line; other users must not be able to\n"
                 "read it (default: a random password in OUTPUT-DIR/password)")
      .typeName("FILE");
  group.addOption("--bitrate-kbps", options.encoder.bitrate_kbps, "H.264 constant bit rate of each camera")
      .range(50, 200'000)
      .captureDefault();
  group.addOption("--slices", options.encoder.slices, "H.264 slices per picture")
      .range(1, 16)
      .captureDefault();
  group
      .addOption("--lead-in", options.lead_in,
                 "Seconds before the content, with its first picture (blank if that may be in motion)")
      .range(0.1, 3600.0)
      .captureDefault();
  group.addOption("--latency-ms", options.latency_ms, "Delay from the exposure of a picture to its sending")
      .range(0.0, 10'000.0)
      .captureDefault();
  group.addFlag("--start-when-watched", options.start_when_watched,
                "Start the lead-in when clients play both cameras, not at once");
  group.addFlag(
      "--loop", options.loop,
      "Repeat the content for ever. The cart jumps back each time, which makes odometry and self-checks fail "
      "there; the ground truth covers the first run");
}

void addFileOptions(Command command, SimulateOptions& options) {
  const auto group = command.addOptionGroup("Files", "Output and cache");
  group
      .addOption("--output-dir", options.output,
                 "Folder for rig.yaml, truth.tum, poses.txt, cameras.json, ...")
      .typeName("DIR")
      .captureDefault();
  group.addOption("--cache-dir", options.cache_dir, "Folder of the cache of encoded streams").typeName("DIR");
  group
      .addOption("--cache-gb", options.cache_gigabytes,
                 "Limit of the cache; least recently used streams are removed first")
      .range(0.0, 1000.0)
      .captureDefault();
  group.addFlag("--no-cache", options.no_cache, "Neither read nor write the cache");
  group.addFlag("--prepare-only", options.prepare_only, "Only render, encode and cache");
  group.addFlag("--render", options.render,
                "Serve no cameras: write an image folder with its ground truth, the output folder");
  group.addFlag("--encode", options.encode,
                "Serve no cameras: write a recording in H.264 with its ground truth, the output folder");
}

}  // namespace

std::vector<std::string> rendererArguments(const SimulateOptions& options) {
  std::vector<std::string> arguments{"--world", options.world, "--frame-rate", exactText(options.frame_rate)};
  const auto add = [&arguments](const char* name, const std::string& value) {
    // Not as two words: a value may begin with a dash.
    if (!value.empty()) arguments.push_back(name + ("=" + value));
  };
  if (options.seconds > 0.0) add("--seconds", exactText(options.seconds));
  if (options.offset_ms) add("--offset-ms", exactText(*options.offset_ms));
  if (options.offset_drift_ppm) add("--offset-drift-ppm", exactText(*options.offset_drift_ppm));
  for (const auto& [name, value] : options.rendering)
    add(name.c_str(), value);
  return arguments;
}

std::function<bool()> addSimulateOptions(Command command, SimulateOptions& options) {
  const std::vector<Option> content = addContentOptions(command, options).options();
  addCameraOptions(command, options);
  addFileOptions(command, options);
  return [content] {
    return std::any_of(content.begin(), content.end(),
                       [](const Option& option) { return option.count() > 0; });
  };
}

}  // namespace cartvo
