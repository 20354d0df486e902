// `cartvo simulate`: two RTSP cameras that show a rendered drive or a recorded sequence with ground truth.
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "capture/rtsp/password_file.hpp"
#include "common/atomic_file.hpp"
#include "common/command_line/parser.hpp"
#include "tools/cartvo/commands.hpp"
#include "tools/cartvo/interruption.hpp"
#include "tools/cartvo/json_text.hpp"
#include "tools/cartvo/progress_bar.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/simulate/content_files.hpp"
#include "tools/simulate/recorded_drive.hpp"
#include "tools/simulate/renderer.hpp"
#include "tools/simulate/sequence_content.hpp"
#include "tools/simulate/server/camera_pair_simulation.hpp"
#include "tools/simulate/server/generated_password.hpp"
#include "tools/simulate/simulate_options.hpp"
#include "tools/simulate/stream/stream_cache.hpp"

namespace cartvo {
namespace {

namespace fs = std::filesystem;
using namespace simulate;  // NOLINT(google-build-using-namespace): this file is that namespace's command line

volatile std::sig_atomic_t stop_requested = 0;

void stopOnSignals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void printLine(const std::string& line) {
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

void warnOfCache(const std::string& problem) {
  std::fprintf(stderr, "cartvo: the streams are not cached and will be made again the next time: %s\n",
               problem.c_str());
}

StreamCache cacheOf(const SimulateOptions& options) {
  return {options.cache_dir, static_cast<std::uint64_t>(options.cache_gigabytes * 1e9)};
}

/// Why nothing can be cached; empty if it can, or is not wanted. Throws std::runtime_error if caching is all
/// that is wanted.
std::string problemOf(const StreamCache& cache, const SimulateOptions& options) {
  std::string problem = options.no_cache ? "" : cache.problem();
  if (!problem.empty() && options.prepare_only)
    throw std::runtime_error(problem + "; name another --cache-dir");
  return problem;
}

std::shared_ptr<const EncodedPair> prepareStreams(const Content& content, const SimulateOptions& options) {
  const std::string key = content.cacheKey() + "\n" + encoderKey(options.encoder);
  const StreamCache cache = cacheOf(options);
  if (!options.no_cache) {
    if (auto cached = cache.load(key)) {
      printLine("streams: cached in " + cache.fileFor(key).string());
      return std::make_shared<const EncodedPair>(*std::move(cached));
    }
  }
  const std::string problem = problemOf(cache, options);
  if (!problem.empty()) warnOfCache(problem);
  printLine("encoding");
  const Interruption interruption;
  ProgressBar bar("pairs");
  auto streams =
      std::make_shared<const EncodedPair>(encodeContent(content, options.encoder, [&](int done, int total) {
        interruption.check();
        bar.show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
      }));
  if (options.no_cache || !problem.empty()) return streams;
  try {
    cache.store(key, *streams);
  } catch (const std::exception& error) {
    if (options.prepare_only) throw;
    warnOfCache(error.what());
  }
  return streams;
}

std::string nameOfContent(const SimulateOptions& options) {
  if (!options.recording.empty()) return "recording " + options.recording.string();
  return options.sequence.empty() ? "world " + options.world : "sequence " + options.sequence.string();
}

void writeCameras(const SimulateOptions& options, const ContentDescription& drive,
                  const CameraPairSimulation& simulation) {
  const calib::Rig rig = drive.rig();
  nlohmann::ordered_json cameras{
      {"left", {{"url", simulation.left().url()}}},
      {"right", {{"url", simulation.right().url()}}},
      {"user", options.user},
      {"width", rig.left.size.width},
      {"height", rig.left.size.height},
      {"frame_rate", drive.frameRate()},
      {"pairs", drive.pairCount()},
      {"readout_ms", {1e3 * rig.left.readout.value_or(0.0), 1e3 * rig.right.readout.value_or(0.0)}},
      {"content", nameOfContent(options)}};
  if (options.recording.empty()) {
    const int last = drive.pairCount() - 1;
    const double first_ns = static_cast<double>(drive.rightInstant(0) - drive.leftInstant(0));
    const double last_ns = static_cast<double>(drive.rightInstant(last) - drive.leftInstant(last));
    const double length_ns = static_cast<double>(std::max<std::int64_t>(1, drive.leftInstant(last)));
    cameras["offset_ms"] = first_ns * 1e-6;
    cameras["offset_drift_ppm"] = std::round((last_ns - first_ns) / length_ns * 1e9) * 1e-3;
    cameras["bitrate_kbps"] = options.encoder.bitrate_kbps;
  }
  // times_0.txt and times_1.txt are relative to this system time.
  if (simulation.epoch()) {
    cameras["epoch_ns"] = *simulation.epoch();
  } else {
    cameras["epoch_ns"] = nullptr;
  }
  writeResultFile(options.output / "cameras.json", jsonText(cameras));
}

CameraPairSettings pairSettings(const SimulateOptions& options) {
  using Seconds = std::chrono::duration<double>;
  const auto nanoseconds = [](double seconds) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(Seconds(seconds));
  };
  return {.left = parseEndpoint(options.left_address),
          .right = parseEndpoint(options.right_address),
          .user = options.user,
          .password = options.password_file.empty() ? ensurePassword(options.output / "password")
                                                    : capture::readPasswordFile(options.password_file),
          .lead_in = nanoseconds(options.lead_in),
          .latency = nanoseconds(options.latency_ms * 1e-3),
          .start = options.start_when_watched ? ContentStart::when_watched : ContentStart::at_once,
          .end = options.loop ? ContentEnd::repeat : ContentEnd::stop};
}

/// Checks, before anything is rendered, what serving needs.
void checkService(const SimulateOptions& options) {
  checkResultFiles({options.output / "cameras.json"});
  createFolders(options.output);
  requireFreeAddresses(pairSettings(options));
}

void serve(const SimulateOptions& options, const ContentDescription& drive,
           const std::shared_ptr<const EncodedPair>& streams) {
  constexpr auto kPollInterval = std::chrono::milliseconds(20);
  constexpr int kMaxPollsAfterEnd = 100;  // two seconds for clients to fetch the last frames
  stopOnSignals();
  if (const auto kept = keepEarlierTruth(options.output))
    printLine("the ground truth of the earlier run is kept: " + kept->string());
  CameraPairSimulation simulation(streams, pairSettings(options));
  writeDescription(options.output, drive);
  writeCameras(options, drive, simulation);
  printLine("ready: " + simulation.left().url() + " " + simulation.right().url());
  if (options.start_when_watched) printLine("waiting until clients play both cameras");

  bool announced = false;
  int polls_after_end = 0;
  while (stop_requested == 0 && polls_after_end < kMaxPollsAfterEnd) {
    simulation.update();
    if (simulation.epoch() && !announced) {
      announced = true;
      writeTruth(options.output, drive, *simulation.epoch());
      writeCameras(options, drive, simulation);
      char line[160];
      std::snprintf(line, sizeof line, "content: %d pairs at %.3f Hz from Unix time %.3f on%s",
                    drive.pairCount(), drive.frameRate(), static_cast<double>(*simulation.epoch()) * 1e-9,
                    options.loop ? ", repeated" : "");
      printLine(line);
    }
    if (simulation.isFinished()) {
      ++polls_after_end;
      if (simulation.left().playingClients() + simulation.right().playingClients() == 0) break;
    }
    std::this_thread::sleep_for(kPollInterval);
  }
  printLine(simulation.isFinished() ? "end of content" : "stopped");
}

void writePictures(const SimulateOptions& options, const Content& content) {
  const Interruption interruption;
  ProgressBar bar("pairs");
  renderFolder(options.output, content, [&](int done, int total) {
    interruption.check();
    bar.show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
  });
  std::printf("%d pairs: %s\n", content.pairCount(), options.output.c_str());
}

void encodeAndServe(const SimulateOptions& options, const Content& content) {
  const std::shared_ptr<const EncodedPair> streams = prepareStreams(content, options);
  if (options.encode) {
    recordFolder(options.output, content, *streams);
    std::printf("%d pairs: %s\n", content.pairCount(), options.output.c_str());
  }
  if (options.serves()) serve(options, content, streams);
}

/// A folder that the destructor removes.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "cartvo-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error(name +
                               ": the folder cannot be made: " + std::generic_category().message(errno));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void renderInto(const Renderer& renderer, const fs::path& folder, const SimulateOptions& options) {
  std::vector<std::string> arguments = rendererArguments(options);
  arguments.push_back("--output-dir=" + folder.string());
  if (options.render) return renderer.run(arguments);
  printLine("rendering");
  renderer.outputOf(arguments);
}

/// Renders a drive, or takes it from the cache, and encodes it.
void runWorld(const SimulateOptions& options) {
  const Renderer renderer;
  if (options.render) return renderInto(renderer, options.output, options);
  std::vector<std::string> arguments = rendererArguments(options);
  arguments.emplace_back("--print-key");
  const std::string output = renderer.outputOf(arguments);
  const std::string key = output.substr(0, output.find('\n'));
  const StreamCache cache = cacheOf(options);
  const bool is_cached = problemOf(cache, options).empty() && !options.no_cache;
  const auto serve_folder = [&](const fs::path& folder) {
    encodeAndServe(options, RenderedDrive(folder, options.frame_rate, key));
  };
  const auto render = [&](const fs::path& folder) { renderInto(renderer, folder, options); };
  if (is_cached) return serve_folder(cache.driveFolder(key, render));
  const TemporaryFolder temporary;
  render(temporary.path() / "drive");
  serve_folder(temporary.path() / "drive");
}

void run(const SimulateOptions& options) {
  if (options.serves()) checkService(options);
  if (!options.recording.empty()) {
    if (!options.serves())
      throw std::runtime_error("--recording is encoded already: there is nothing to prepare or to write");
    const RecordedDrive drive(options.recording, options.seconds, options.encoder);
    return serve(options, drive, drive.streams());
  }
  if (options.sequence.empty()) return runWorld(options);
  const SequenceContent content(options.sequence,
                                SequenceSettings{.seconds = options.seconds,
                                                 .offset_s = options.offset_ms.value_or(0.0) * 1e-3,
                                                 .offset_drift_ppm = options.offset_drift_ppm.value_or(0.0)});
  if (options.render) return writePictures(options, content);
  encodeAndServe(options, content);
}

}  // namespace

void addCommands(Command cartvo) {
  const Command command = addNamedCommand(cartvo, "simulate");
  const auto options = std::make_shared<SimulateOptions>();
  const auto names_content = addSimulateOptions(command, *options);
  command.footer(
      "Each camera is an RTSP server, rtsp://ADDRESS:PORT/Streaming/Channels/101, with H.264 without "
      "B-frames,\n"
      "Digest authentication (user admin, password in OUTPUT-DIR/password) and RTCP sender reports that "
      "carry\n"
      "the exposure instants. The line 'ready: URL URL' is printed when both listen. Encoded streams are "
      "cached.\n"
      "Exits with code 0 after the content, or on SIGTERM.\n"
      "By default rendered cameras are as users have them: wide lenses, rolling shutters, free-running "
      "clocks.\n"
      "Rendering needs the program cartvo-render of the package cartvo-lab.\n"
      "Examples:\n"
      "  cartvo simulate                                      the sample drive; nothing is rendered\n"
      "  cartvo simulate --world campus                       a rendered drive of six seconds\n"
      "  cartvo simulate --recording drive                    a recording of cartvod\n"
      "  cartvo simulate --world turns --offset-ms 12         the right camera exposed 12 ms later\n"
      "  cartvo simulate --offset-ms 0 --readout-ms 0         synchronised global shutters\n"
      "  cartvo simulate --sequence ../shared/data/kitti_06   a recorded sequence\n"
      "  cartvo simulate --render --output-dir drive          an image folder instead of streams");
  command.callback([options, names_content] {
    if (options->serves() && !names_content()) options->recording = sampleDrive();
    run(*options);
  });
}

}  // namespace cartvo
