// The command line of `cartvo benchmark speed`.
#include "tools/benchmark/speed/benchmark_speed.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/command_line/parser.hpp"
#include "common/image_size.hpp"
#include "daemon/service/configuration_names.hpp"
#include "tools/benchmark/benchmark_options.hpp"
#include "tools/benchmark/speed/speed_benchmark.hpp"
#include "tools/benchmark/speed/speed_report.hpp"
#include "tools/cartvo/result_files.hpp"
#include "tools/simulate/stream/stream_cache.hpp"

namespace cartvo {
namespace {

using namespace benchmark;  // NOLINT(google-build-using-namespace): this file is that namespace's command
                            // line

struct SpeedOptions {
  BenchmarkOptions common;
  std::vector<std::string> sizes{"680x420", "1241x376", "1280x720", "1920x1080"};
  std::vector<int> features{500, 1000, 2000, 9600};
  std::vector<int> thread_counts{1, 2};
  std::string estimator = daemon::nameOf(vo::OdometrySettings{}.estimator, daemon::kEstimators);
  int pairs = SpeedSettings{}.pairs;
  int repeats = SpeedSettings{}.repeats;
  std::filesystem::path cache = simulate::StreamCache::defaultFolder();
};

constexpr const char* kNoSize = "none";

std::string checkSize(const std::string& text) {
  if (text == kNoSize) return "";
  constexpr int kMinSide = 160, kMaxSide = 8192;  // px
  const cv::Size size = parseImageSize(text).value_or(cv::Size());
  const bool fits =
      std::min(size.width, size.height) >= kMinSide && std::max(size.width, size.height) <= kMaxSide;
  return fits ? "" : "'" + text + "': expected WIDTHxHEIGHT, each from 160 to 8192, such as 680x420, or none";
}

void run(const SpeedOptions& options) {
  checkResultFiles({options.common.output});
  SpeedSettings settings;
  for (const std::string& size : options.sizes)
    if (size != kNoSize) settings.sizes.push_back(parseImageSize(size).value());
  settings.data = dataFolder(options.common);
  settings.features = options.features;
  settings.threads = options.thread_counts;
  settings.odometry.estimator = daemon::valueNamed(options.estimator, daemon::kEstimators);
  settings.rendering_threads = options.common.threads;
  settings.pairs = options.pairs;
  settings.repeats = options.repeats;
  settings.cache = options.cache;
  WorkDisplay display;
  const std::vector<SpeedResult> results = runSpeedBenchmark(settings, display.observer());
  writeReport(
      options.common, "speed", [&] { return speedJson(results); },
      [&](ReportFormat format) { return speedTables(results, format); });
}

void addChoices(Command command, SpeedOptions& options) {
  command.addOption("--sizes", options.sizes, "Image sizes of the rendered campus drive, or none")
      .delimiter(',')
      .check(checkSize, "WIDTHxHEIGHT")
      .typeName("LIST")
      .captureDefault();
  command.addOption("--features", options.features, "Target numbers of features in each left image")
      .delimiter(',')
      .range(50, 20000)
      .typeName("LIST")
      .captureDefault();
  command.addOption("--thread-counts", options.thread_counts, "Numbers of threads for the odometry")
      .delimiter(',')
      .range(1, 64)
      .typeName("LIST")
      .captureDefault();
  command.addOption("--estimator", options.estimator, "Estimator to time")
      .choices(daemon::namesOf(daemon::kEstimators))
      .captureDefault();
  command
      .addOption("--pairs", options.pairs,
                 "Maximum number of pairs of each drive; the first four are not counted")
      .range(kWarmUpPairs + 2, 10000)
      .captureDefault();
  command.addOption("--repeats", options.repeats, "Repetitions of each drive")
      .range(1, 1000)
      .captureDefault();
  command.addOption("--cache-dir", options.cache, "Folder for rendered worlds")
      .typeName("DIR")
      .captureDefault();
}

}  // namespace

void addSpeedBenchmark(Command benchmark) {
  const Command command =
      benchmark.addSubcommand("speed", "Measure the time of a pair and of its stages, relative to OpenCV");
  const auto options = std::make_shared<SpeedOptions>();
  addBenchmarkOptions(command, options->common);
  addChoices(command, *options);
  command.footer(
      "A campus drive is rendered once in each size, which takes some minutes. These drives and the real "
      "sequences are\n"
      "read into memory and run through the daemon's stages from the raw images to the pose. Sequences with "
      "rectified\n"
      "images are run a second time with lens distortion. OpenCV's remap, pyramids and KLT are timed in "
      "between on images\n"
      "of the same drives, so ratios are valid on a busy machine too. "
      "build/release/tools/benchmark/cartvo_kernels times the\n"
      "inner loops separately.\n"
      "Examples:\n"
      "  cartvo benchmark speed --sizes 680x420 --features 1000 --data none\n"
      "  cartvo benchmark speed --sizes none --data ../shared/data --pairs 60 --repeats 5\n"
      "  cartvo benchmark speed --format markdown --output speed.md");
  command.callback([options] { run(*options); });
}

}  // namespace cartvo
