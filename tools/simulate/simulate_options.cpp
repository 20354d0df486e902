// Command-line options of `cartvo simulate`.
#include "tools/simulate/simulate_options.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <stdexcept>
#include <vector>

#include "common/command_line/parser.hpp"
#include "common/image_size.hpp"
#include "tools/cartvo/readout_option.hpp"
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

/// Options of the drive's motion and of the rolling shutter, to which it matters.
void addMotionOptions(Command group, SimulateOptions& options, Option sequence) {
  group
      .addOption("--liveliness", options.drive.liveliness,
                 "How lively the drive is, from 0 to 1: it weaves, meets kerbs and bumps, accelerates\n"
                 "and brakes briskly (not motorway)")
      .range(0.0, 1.0)
      .excludes(sequence)
      .captureDefault();
  group
      .addOption("--start-at", options.drive.start_seconds,
                 "Instant of the drive, s, at which the pictures begin (default: 0, at standstill; of\n"
                 "a lively drive: 5, in motion)")
      .range(0.0, 3600.0)
      .excludes(sequence);
  addReadoutOption(group, options.readout_ms, "default: 32, or 0.96 of a shorter frame period")
      .excludes(sequence);
  const Option frequency = group
                               .addOption("--shake-hz", options.drive.shake.frequency,
                                          "Frequency at which the rendered cameras' mount vibrates")
                               .range(0.1, 50.0)
                               .excludes(sequence);
  const Option amplitude =
      group
          .addOption("--shake-degrees", options.shake_degrees,
                     "Amplitude of that vibration in pitch; that in roll is 0.6 of it. The true poses\n"
                     "contain it")
          .range(0.0, 5.0)
          .excludes(sequence);
  frequency.needs(amplitude);
  amplitude.needs(frequency);
}

/// Returns the group.
Command addContentOptions(Command command, SimulateOptions& options) {
  std::string worlds;
  for (const world::Scenario scenario : world::allScenarios()) {
    worlds += (worlds.empty() ? "" : ", ") + std::string(world::scenarioName(scenario));
  }
  const auto group = command.addOptionGroup("Content", "What the cameras show");
  const Option world = group.addOption("--world", options.world, "A rendered drive: " + worlds)
                           .typeName("NAME")
                           .check(validatorFor(world::scenarioFromName));
  const Option sequence = group
                              .addOption("--sequence", options.sequence,
                                         "A recorded image sequence (KITTI or EuRoC layout), at its own rate")
                              .typeName("DIR");
  world.captureDefault();
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
  group.addOption("--seed", options.drive.seed, "Seed of the rendered world and its noise").captureDefault();
  group
      .addOption("--size", options.size, "Size of the rendered images, px; the field of view does not change")
      .typeName("WIDTHxHEIGHT")
      .check(validatorFor(parseSize))
      .captureDefault();
  const Option rate =
      group.addOption("--frame-rate", options.drive.frame_rate, "Frame rate of the rendered cameras, Hz")
          .range(1.0, 120.0)
          .captureDefault();
  rate.excludes(sequence);
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
  addMotionOptions(group, options, sequence);
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

cv::Size parseSize(const std::string& text) {
  const std::optional<cv::Size> size = parseImageSize(text);
  if (!size) throw std::invalid_argument("'" + text + "' is not WIDTHxHEIGHT, such as 680x420");
  return *size;
}

CameraTiming cameraTiming(const SimulateOptions& options) {
  constexpr double kUsualReadout = 0.032;  // s, of sensors that run at 30 Hz whatever frame rate is set
  constexpr double kReadoutShare = 0.96;   // of the frame period of a sensor
  const bool is_rendered = options.sequence.empty();
  const double period = 1.0 / options.drive.frame_rate;
  CameraTiming timing;
  if (!options.readout_ms.empty()) {
    timing.readouts = parseReadouts(options.readout_ms);
  } else if (is_rendered) {
    timing.readouts.left = timing.readouts.right = std::min(kUsualReadout, kReadoutShare * period);
  }
  if (options.offset_ms || options.offset_drift_ppm || !is_rendered) {
    timing.offset_ms = options.offset_ms.value_or(0.0);
    timing.offset_drift_ppm = options.offset_drift_ppm.value_or(0.0);
  } else {
    const double seconds = options.seconds > 0.0 ? options.seconds : options.drive.seconds;
    timing.offset_ms = -0.25e3 * period;
    timing.offset_drift_ppm = std::min(1e6 * period / seconds, kMaxDrift);
  }
  return timing;
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
