// How long a pair takes, beside what OpenCV takes for a fixed piece of work.
#include "tools/benchmark/speed_benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/core/utility.hpp>

#include "calib/rectification_tables.hpp"
#include "calib/rectifier.hpp"
#include "capture/image_folder.hpp"
#include "capture/stereo_source.hpp"
#include "daemon/health_monitor.hpp"
#include "daemon/pair_processor.hpp"
#include "tools/benchmark/sequence.hpp"
#include "tools/replay/source_rig.hpp"

namespace cartvo::benchmark {
namespace {

/// A drive, in memory.
struct Drive {
  Rig rig;
  std::vector<FramePair> pairs;
};

/// The view of the usual cameras, in more or fewer pixels.
world::WorldSettings worldOf(cv::Size size, const SpeedSettings& settings) {
  world::WorldSettings world;
  world.focal_length *= static_cast<double>(size.width) / world.image_size.width;
  world.image_size = size;
  world.lead_in_seconds = 0.0;
  world.seconds = settings.pairs / world.frame_rate;
  world.threads = settings.rendering_threads;
  return world;
}

Drive loadDrive(const std::filesystem::path& folder, int pairs) {
  Drive drive;
  drive.rig = findRig(openSource(folder), folder, {}).rig;
  const ImageFolder images = readImageFolder(folder);
  const auto frame = [](const ImageSequence& camera, std::size_t index) {
    Frame read;
    read.image = readGreyImage(camera.images[index]);
    read.exposure_ns = camera.instants_ns[index];
    read.sequence = index;
    return read;
  };
  const std::size_t count = std::min(images.left.images.size(), static_cast<std::size_t>(pairs));
  for (std::size_t i = 0; i < count; ++i)
    drive.pairs.push_back({frame(images.left, i), frame(images.right, i)});
  return drive;
}

/// Gathers the times of one row.
class Samples {
 public:
  void add(const PairResult& result) {
    const StageTimes& times = result.times;
    raw_.push_back(1e3 * times.total);
    rectified_.push_back(1e3 * (times.total - times.of(Stage::rectify)));
    for (int i = 0; i < kStageCount; ++i)
      stages_[i].push_back(1e3 * times.stages[i]);
    used_.push_back(result.estimate.counts.inliers);
  }
  void add(const ReferenceTimes& times) {
    remap_.push_back(times.remap);
    pyramids_.push_back(times.pyramids);
    klt_.push_back(times.klt);
  }

  SpeedResult result() const {
    SpeedResult result;
    result.pairs = raw_.size();
    result.used = percentile(used_, 0.5);
    result.rectified = distributionOf(rectified_);
    result.raw = distributionOf(raw_);
    for (int i = 0; i < kStageCount; ++i)
      result.stages[i] = percentile(stages_[i], 0.5);
    result.reference = {percentile(remap_, 0.5), percentile(pyramids_, 0.5), percentile(klt_, 0.5)};
    return result;
  }

 private:
  std::vector<double> raw_, rectified_, used_, remap_, pyramids_, klt_;
  std::array<std::vector<double>, kStageCount> stages_;
};

SpeedResult timeDrive(const Drive& drive, const Rectifier& rectifier, const OdometrySettings& odometry,
                      int threads, int repeats, const simulate::Progress& progress) {
  const ReferenceWork reference(drive.pairs[0].left.image, drive.pairs[1].left.image);
  Samples samples;
  const int count = static_cast<int>(drive.pairs.size());
  for (int repeat = 0; repeat < repeats; ++repeat) {
    samples.add(reference.run());  // between the repeats, as a busy machine is busy for seconds
    cv::setNumThreads(threads);
    PairProcessor processor(drive.rig, rectifier, odometry);
    for (int i = 0; i < count; ++i) {
      const PairResult result = processor.process(drive.pairs[i]);
      if (i >= kWarmUp) samples.add(result);
      progress(repeat * count + i + 1, repeats * count);
    }
    samples.add(reference.run());
  }
  return samples.result();
}

void check(const SpeedSettings& settings) {
  if (settings.sizes.empty() || settings.features.empty() || settings.threads.empty() || settings.repeats < 1)
    throw std::invalid_argument("nothing to time: sizes, features, threads and repeats are needed");
  if (settings.pairs < kWarmUp + 2)
    throw std::invalid_argument("too few pairs to time: the first " + std::to_string(kWarmUp) +
                                " do not count");
}

}  // namespace

Distribution distributionOf(const std::vector<double>& milliseconds) {
  return {percentile(milliseconds, 0.5), percentile(milliseconds, 0.99),
          *std::max_element(milliseconds.begin(), milliseconds.end())};
}

double growthExponent(const std::vector<double>& amounts, const std::vector<double>& times) {
  const double count = static_cast<double>(amounts.size());
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < amounts.size(); ++i) {
    const double amount = std::log(amounts[i]), time = std::log(times[i]);
    x += amount;
    y += time;
    xx += amount * amount;
    xy += amount * time;
  }
  return (count * xy - x * y) / (count * xx - x * x);
}

std::vector<SpeedResult> runSpeedBenchmark(const SpeedSettings& settings, const WorkObserver& observer) {
  check(settings);
  const WorldCache worlds(settings.cache / "worlds");
  std::vector<SpeedResult> results;
  for (const cv::Size& size : settings.sizes) {
    const std::string name = std::to_string(size.width) + "x" + std::to_string(size.height);
    observer.begin(name + ": rendering, unless it is cached");
    const Sequence sequence = renderedSequence(worldOf(size, settings), worlds, observer.progress);
    const Drive drive = loadDrive(sequence.folder, settings.pairs);
    const RectificationSettings rectification;
    const Rectifier rectifier(drive.rig, rectification, buildTables(drive.rig, rectification));
    for (const int features : settings.features) {
      for (const int threads : settings.threads) {
        observer.begin(name + ": " + std::to_string(features) +
                       " features, threads: " + std::to_string(threads));
        OdometrySettings odometry = settings.odometry;
        odometry.features = features;
        SpeedResult result =
            timeDrive(drive, rectifier, odometry, threads, settings.repeats, observer.progress);
        result.size = size;
        result.features = features;
        result.threads = threads;
        results.push_back(result);
      }
    }
  }
  return results;
}

}  // namespace cartvo::benchmark
