// The command line of `cartvo simulate`.
#include "tools/cartvo/simulate_options.hpp"

#include <optional>
#include <stdexcept>

#include "calib/image_size.hpp"
#include "tools/simulate/camera_pair_simulation.hpp"

namespace cartvo {
namespace {

/// A check of an option: what `parse` does not take is a wrong command line.
template <typename Parse>
auto takenBy(Parse parse) {
  return [parse](const std::string& text) -> std::string {
    try {
      parse(text);
      return {};
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
}

void addContentOptions(CLI::App& command, SimulateOptions& options) {
  std::string worlds;
  for (const world::Scenario scenario : world::allScenarios()) {
    worlds += (worlds.empty() ? "" : ", ") + std::string(world::scenarioName(scenario));
  }
  const auto group = command.add_option_group("Content", "What the cameras see");
  CLI::Option* world = group->add_option("--world", options.world, "A rendered drive: " + worlds)
                           ->type_name("NAME")
                           ->check(takenBy(world::scenarioFromName));
  CLI::Option* sequence =
      group
          ->add_option("--sequence", options.sequence,
                       "A recorded image sequence (KITTI or EuRoC layout), at its own rate")
          ->type_name("DIR");
  world->capture_default_str();
  sequence->excludes(world);
  group->add_option("--seconds", options.seconds, "Length (default: 60 rendered, or the whole sequence)")
      ->check(CLI::Range(0.05, 36000.0));
  group->add_option("--seed", options.drive.seed, "Another seed, another world")->capture_default_str();
  group->add_option("--size", options.size, "Rendered picture, px; the field of view stays")
      ->type_name("WIDTHxHEIGHT")
      ->check(takenBy(parseSize))
      ->capture_default_str();
  CLI::Option* rate =
      group->add_option("--frame-rate", options.drive.frame_rate, "Of the rendered cameras, Hz")
          ->check(CLI::Range(1.0, 120.0))
          ->capture_default_str();
  rate->excludes(sequence);
  group
      ->add_option("--offset-ms", options.offset_ms,
                   "How much later the right camera is exposed. A sequence's pictures stay\n"
                   "what they are: only their instants move")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
  group
      ->add_option("--offset-drift-ppm", options.offset_drift_ppm,
                   "The right camera's period is longer by this (free-running crystals)")
      ->check(CLI::Range(-10000.0, 10000.0))
      ->capture_default_str();
}

void addCameraOptions(CLI::App& command, SimulateOptions& options) {
  const auto group = command.add_option_group("Cameras", "How they serve it");
  group->add_option("--left", options.left, "Where the left camera listens")
      ->type_name("ADDRESS:PORT")
      ->check(takenBy(simulate::parseEndpoint))
      ->capture_default_str();
  group->add_option("--right", options.right, "Where the right camera listens")
      ->type_name("ADDRESS:PORT")
      ->check(takenBy(simulate::parseEndpoint))
      ->capture_default_str();
  group->add_option("--user", options.user, "User for Digest authentication")->capture_default_str();
  group
      ->add_option("--password-file", options.password_file,
                   "Its first line is the password; others must not be able to read it\n"
                   "(default: a random one in OUTPUT-DIR/password)")
      ->type_name("FILE");
  group->add_option("--bitrate-kbps", options.encoder.bitrate_kbps, "H.264 constant bit rate of each camera")
      ->check(CLI::Range(50, 200'000))
      ->capture_default_str();
  group->add_option("--slices", options.encoder.slices, "H.264 slices per picture")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  group
      ->add_option("--lead-in", options.lead_in,
                   "Seconds for which the first picture stands still (a sequence: blank)")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  group->add_option("--latency-ms", options.latency_ms, "From a picture's exposure to its sending")
      ->check(CLI::Range(0.0, 10'000.0))
      ->capture_default_str();
  group->add_flag("--start-when-watched", options.start_when_watched,
                  "The lead-in begins when both cameras are being played, not at once");
  group->add_flag("--loop", options.loop, "Repeat the content for ever; the truth is that of the first turn");
}

void addFileOptions(CLI::App& command, SimulateOptions& options) {
  const auto group = command.add_option_group("Files", "Where things are kept");
  group->add_option("--output-dir", options.output, "For rig.yaml, truth.tum, poses.txt, cameras.json, ...")
      ->type_name("DIR")
      ->capture_default_str();
  group->add_option("--cache-dir", options.cache_dir, "For streams that were rendered and encoded")
      ->type_name("DIR");
  group->add_option("--cache-gb", options.cache_gigabytes, "What the cache may take; the oldest go first")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  group->add_flag("--no-cache", options.no_cache, "Neither look into the cache nor add to it");
  group->add_flag("--prepare-only", options.prepare_only, "Only render, encode and cache");
  group->add_option("--render", options.render, "Serve nothing: write an image folder with its truth")
      ->type_name("DIR");
}

}  // namespace

cv::Size parseSize(const std::string& text) {
  const std::optional<cv::Size> size = sizeFrom(text);
  if (!size) throw std::invalid_argument("'" + text + "' is not WIDTHxHEIGHT, such as 680x420");
  return *size;
}

void addSimulateOptions(CLI::App& command, SimulateOptions& options) {
  addContentOptions(command, options);
  addCameraOptions(command, options);
  addFileOptions(command, options);
}

}  // namespace cartvo
