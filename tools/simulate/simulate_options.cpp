// Command-line options of `cartvo simulate`.
#include "tools/simulate/simulate_options.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "common/image_size.hpp"
#include "tools/cartvo/readout_option.hpp"
#include "tools/simulate/recorded_drive.hpp"
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
void addMotionOptions(CLI::App& group, SimulateOptions& options, CLI::Option* sequence) {
  group
      .add_option("--liveliness", options.drive.liveliness,
                  "How lively the drive is, from 0 to 1: it weaves, meets kerbs and bumps, accelerates\n"
                  "and brakes briskly (not motorway)")
      ->check(CLI::Range(0.0, 1.0))
      ->excludes(sequence)
      ->capture_default_str();
  group
      .add_option("--start-at", options.drive.start_seconds,
                  "Instant of the drive, s, at which the pictures begin (default: 0, at standstill; of\n"
                  "a lively drive: 5, in motion)")
      ->check(CLI::Range(0.0, 3600.0))
      ->excludes(sequence);
  addReadoutOption(group, options.readout_ms, "default: 32, or 0.96 of a shorter frame period")
      ->excludes(sequence);
  CLI::Option* frequency = group
                               .add_option("--shake-hz", options.drive.shake.frequency,
                                           "Frequency at which the rendered cameras' mount vibrates")
                               ->check(CLI::Range(0.1, 50.0))
                               ->excludes(sequence);
  CLI::Option* amplitude =
      group
          .add_option("--shake-degrees", options.shake_degrees,
                      "Amplitude of that vibration in pitch; that in roll is 0.6 of it. The true poses\n"
                      "contain it")
          ->check(CLI::Range(0.0, 5.0))
          ->excludes(sequence);
  frequency->needs(amplitude);
  amplitude->needs(frequency);
}

CLI::App& addContentOptions(CLI::App& command, SimulateOptions& options) {
  std::string worlds;
  for (const world::Scenario scenario : world::allScenarios()) {
    worlds += (worlds.empty() ? "" : ", ") + std::string(world::scenarioName(scenario));
  }
  const auto group = command.add_option_group("Content", "What the cameras show");
  CLI::Option* world = group->add_option("--world", options.world, "A rendered drive: " + worlds)
                           ->type_name("NAME")
                           ->check(validatorFor(world::scenarioFromName));
  CLI::Option* sequence =
      group
          ->add_option("--sequence", options.sequence,
                       "A recorded image sequence (KITTI or EuRoC layout), at its own rate")
          ->type_name("DIR");
  world->capture_default_str();
  sequence->excludes(world);
  CLI::Option* recording =
      group
          ->add_option("--recording", options.recording,
                       "A recording of cartvod in H.264, or a drive by --encode (default: the sample\n"
                       "drive, unless another option of this group is given)")
          ->type_name("DIR");
  recording->excludes(world)->excludes(sequence);
  group
      ->add_option("--seconds", options.seconds,
                   "Length in seconds (default: 6 if rendered, or the whole sequence or recording);\n"
                   "a second takes some ten seconds to render, once")
      ->check(CLI::Range(0.05, 36000.0));
  group->add_option("--seed", options.drive.seed, "Seed of the rendered world and its noise")
      ->capture_default_str();
  group
      ->add_option("--size", options.size,
                   "Size of the rendered images, px; the field of view does not change")
      ->type_name("WIDTHxHEIGHT")
      ->check(validatorFor(parseSize))
      ->capture_default_str();
  CLI::Option* rate =
      group->add_option("--frame-rate", options.drive.frame_rate, "Frame rate of the rendered cameras, Hz")
          ->check(CLI::Range(1.0, 120.0))
          ->capture_default_str();
  rate->excludes(sequence);
  group
      ->add_option("--offset-ms", options.offset_ms,
                   "Time offset: right minus left exposure. For a sequence only the timestamps\n"
                   "change, not the pictures (default: 0 for a sequence or with\n"
                   "--offset-drift-ppm; else the cameras run free, and the offset passes through\n"
                   "all values)")
      ->check(CLI::Range(-1000.0, 1000.0));
  group
      ->add_option("--offset-drift-ppm", options.offset_drift_ppm,
                   "Relative excess of the right camera's frame period (default: see\n"
                   "--offset-ms)")
      ->check(CLI::Range(-kMaxDrift, kMaxDrift));
  addMotionOptions(*group, options, sequence);
  for (CLI::Option* option : group->get_options())
    if (option != recording && option->get_name() != "--seconds") option->excludes(recording);
  return *group;
}

void addCameraOptions(CLI::App& command, SimulateOptions& options) {
  const auto group = command.add_option_group("Cameras", "How the cameras send it");
  group->add_option("--left-address", options.left_address, "Address of the left camera's RTSP server")
      ->type_name("ADDRESS:PORT")
      ->check(validatorFor(simulate::parseEndpoint))
      ->capture_default_str();
  group->add_option("--right-address", options.right_address, "Address of the right camera's RTSP server")
      ->type_name("ADDRESS:PORT")
      ->check(validatorFor(simulate::parseEndpoint))
      ->capture_default_str();
  group->add_option("--user", options.user, "User for Digest authentication")->capture_default_str();
  group
      ->add_option("--password-file", options.password_file,
                   "File with the password in its first line; other users must not be able to\n"
                   "read it (default: a random password in OUTPUT-DIR/password)")
      ->type_name("FILE");
  group->add_option("--bitrate-kbps", options.encoder.bitrate_kbps, "H.264 constant bit rate of each camera")
      ->check(CLI::Range(50, 200'000))
      ->capture_default_str();
  group->add_option("--slices", options.encoder.slices, "H.264 slices per picture")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  group
      ->add_option("--lead-in", options.lead_in,
                   "Seconds before the content, with its first picture (blank if that may be in motion)")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  group->add_option("--latency-ms", options.latency_ms, "Delay from the exposure of a picture to its sending")
      ->check(CLI::Range(0.0, 10'000.0))
      ->capture_default_str();
  group->add_flag("--start-when-watched", options.start_when_watched,
                  "Start the lead-in when clients play both cameras, not at once");
  group->add_flag(
      "--loop", options.loop,
      "Repeat the content for ever. The cart jumps back each time, which makes odometry and self-checks fail "
      "there; the ground truth covers the first run");
}

void addFileOptions(CLI::App& command, SimulateOptions& options) {
  const auto group = command.add_option_group("Files", "Output and cache");
  group
      ->add_option("--output-dir", options.output,
                   "Folder for rig.yaml, truth.tum, poses.txt, cameras.json, ...")
      ->type_name("DIR")
      ->capture_default_str();
  group->add_option("--cache-dir", options.cache_dir, "Folder of the cache of encoded streams")
      ->type_name("DIR");
  group
      ->add_option("--cache-gb", options.cache_gigabytes,
                   "Limit of the cache; least recently used streams are removed first")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  group->add_flag("--no-cache", options.no_cache, "Neither read nor write the cache");
  group->add_flag("--prepare-only", options.prepare_only, "Only render, encode and cache");
  group->add_flag("--render", options.render,
                  "Serve no cameras: write an image folder with its ground truth, the output folder");
  group->add_flag("--encode", options.encode,
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

void addSimulateOptions(CLI::App& command, SimulateOptions& options) {
  CLI::App& content = addContentOptions(command, options);
  addCameraOptions(command, options);
  addFileOptions(command, options);
  command.parse_complete_callback([&content, &options] {
    const std::vector<CLI::Option*> given =
        content.get_options([](const CLI::Option* option) { return option->count() > 0; });
    const bool makes_files = options.render || options.encode || options.prepare_only;
    if (given.empty() && !makes_files) options.recording = simulate::sampleDrive();
  });
}

}  // namespace cartvo
