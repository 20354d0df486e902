// Measures the time of a pair and of fixed reference work of OpenCV on the same images.
#include "tools/benchmark/speed/speed_benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/core/utility.hpp>

#include "calib/rectification/rectification_tables.hpp"
#include "calib/rectification/rectifier.hpp"
#include "common/image_size.hpp"
#include "common/statistics.hpp"
#include "pipeline/pair_processor.hpp"
#include "tools/benchmark/sequence.hpp"
#include "tools/benchmark/speed/drive_in_memory.hpp"

namespace cartvo::benchmark {
namespace {

void requirePairs(int pairs) {
  if (pairs < kWarmUpPairs + 2) {
    throw std::invalid_argument("too few pairs to time: " + std::to_string(pairs) + "; the first " +
                                std::to_string(kWarmUpPairs) + " are not counted, and two more are needed");
  }
}

void check(const SpeedSettings& settings) {
  if ((settings.sizes.empty() && settings.data.empty()) || settings.features.empty() ||
      settings.threads.empty() || settings.repeats < 1)
    throw std::invalid_argument(
        "nothing to time: give sizes or real sequences, features, threads and at least one repeat");
  requirePairs(settings.pairs);
}

/// The default world with the given image size and an unchanged field of view.
world::WorldSettings worldOf(cv::Size size, const SpeedSettings& settings) {
  world::WorldSettings world;
  world.focal_length *= static_cast<double>(size.width) / world.image_size.width;
  world.image_size = size;
  world.lead_in_seconds = 0.0;
  world.seconds = settings.pairs / world.frame_rate;
  world.threads = settings.rendering_threads;
  return world;
}

/// Collects the times of one result.
class Samples {
 public:
  void add(const pipeline::PairResult& result) {
    const pipeline::StageTimes& times = result.times;
    raw_.push_back(1e3 * times.total);
    rectified_.push_back(1e3 * (times.total - times.stage(vo::Stage::rectify)));
    for (int i = 0; i < vo::kStageCount; ++i)
      stages_[i].push_back(1e3 * times.stages[i]);
    used_.push_back(result.estimate.counts.inliers);
  }
  void add(const ReferenceTimes& times) {
    remap_.push_back(times.remap);
    pyramids_.push_back(times.pyramids);
    klt_.push_back(times.klt);
  }
  /// Computes the ratios of the pairs of one repeat to the reference times measured before and after it.
  void endRepeat(const ReferenceTimes& before, const ReferenceTimes& after) {
    const double klt = 0.5 * (before.klt + after.klt), remap = 0.5 * (before.remap + after.remap);
    for (std::size_t i = raw_ratios_.size(); i < raw_.size(); ++i) {
      rectified_ratios_.push_back(rectified_[i] / klt);
      raw_ratios_.push_back(raw_[i] / (klt + remap));
    }
  }

  SpeedResult result() const {
    SpeedResult result;
    result.pairs = raw_.size();
    result.used = percentile(used_, 0.5);
    result.rectified = distributionOf(rectified_);
    result.raw = distributionOf(raw_);
    for (int i = 0; i < vo::kStageCount; ++i)
      result.stages[i] = percentile(stages_[i], 0.5);
    result.reference = {percentile(remap_, 0.5), percentile(pyramids_, 0.5), percentile(klt_, 0.5)};
    result.rectified_ratio = percentile(rectified_ratios_, 0.5);
    result.raw_ratio = percentile(raw_ratios_, 0.5);
    return result;
  }

 private:
  std::vector<double> raw_, rectified_, used_, remap_, pyramids_, klt_, rectified_ratios_, raw_ratios_;
  std::array<std::vector<double>, vo::kStageCount> stages_;
};

std::vector<cv::Mat> leftImages(const DriveInMemory& drive) {
  std::vector<cv::Mat> images;
  for (const capture::FramePair& pair : drive.pairs)
    images.push_back(pair.left.image);
  return images;
}

SpeedResult timeDrive(const DriveInMemory& drive, const calib::Rectifier& rectifier,
                      const vo::OdometrySettings& odometry, int threads, int repeats,
                      const simulate::Progress& progress) {
  const ReferenceWork reference(leftImages(drive));
  Samples samples;
  const int count = static_cast<int>(drive.pairs.size());
  reference.run();  // allocates memory
  ReferenceTimes before = reference.run();
  samples.add(before);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    cv::setNumThreads(threads);
    pipeline::PairProcessor processor(drive.rig, rectifier, {.odometry = odometry});
    for (int i = 0; i < count; ++i) {
      const pipeline::PairResult result = processor.process(drive.pairs[i]);
      if (i >= kWarmUpPairs) samples.add(result);
      progress(repeat * count + i + 1, repeats * count);
    }
    const ReferenceTimes after = reference.run();
    samples.add(after);
    samples.endRepeat(before, after);  // close in time: the load of a busy machine changes within seconds
    before = after;
  }
  return samples.result();
}

/// Adds one result for each number of features and threads.
void timeEach(const DriveInMemory& drive, const SpeedSettings& settings, const WorkObserver& observer,
              std::vector<SpeedResult>& results) {
  const calib::RectificationSettings rectification;
  const calib::Rectifier rectifier(drive.rig, rectification, calib::buildTables(drive.rig, rectification));
  for (const int features : settings.features) {
    for (const int threads : settings.threads) {
      observer.begin({drive.name + ", " + sizeText(drive.rig.left.size) + ": " + std::to_string(features) +
                      " features, threads: " + std::to_string(threads)});
      vo::OdometrySettings odometry = settings.odometry;
      odometry.features = features;
      SpeedResult result =
          timeDrive(drive, rectifier, odometry, threads, settings.repeats, observer.progress);
      result.drive = drive.name;
      result.size = drive.rig.left.size;
      result.features = features;
      result.threads = threads;
      results.push_back(result);
    }
  }
}

DriveInMemory renderedDrive(cv::Size size, const SpeedSettings& settings, const WorldCache& worlds,
                            const WorkObserver& observer) {
  observer.begin({sizeText(size) + ": rendering, unless it is cached"});
  const Sequence sequence = renderedSequence(worldOf(size, settings), worlds, observer.progress);
  return loadDrive("campus", sequence.folder, settings.pairs);
}

void timeReal(const Sequence& sequence, const SpeedSettings& settings, const WorkObserver& observer,
              std::vector<SpeedResult>& results) {
  const DriveInMemory drive = loadDrive(sequence.name, sequence.folder, settings.pairs);
  try {
    requirePairs(static_cast<int>(drive.pairs.size()));
    timeEach(drive, settings, observer, results);
    if (isRectified(drive)) timeEach(throughLenses(drive), settings, observer, results);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(sequence.folder.string() + ": " + error.what());
  }
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
  const std::vector<Sequence> real = realSequences(settings.data);  // errors before the long work
  const WorldCache worlds(settings.cache / "worlds");
  std::vector<SpeedResult> results;
  for (const cv::Size& size : settings.sizes)
    timeEach(renderedDrive(size, settings, worlds, observer), settings, observer, results);
  for (const Sequence& sequence : real)
    timeReal(sequence, settings, observer, results);
  return results;
}

}  // namespace cartvo::benchmark
