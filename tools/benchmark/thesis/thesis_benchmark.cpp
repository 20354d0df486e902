// Repeats the experiments of the thesis.
#include "tools/benchmark/thesis/thesis_benchmark.hpp"

#include <algorithm>

#include "daemon/service/configuration_names.hpp"

namespace cartvo::benchmark {
namespace {

world::WorldSettings depthWorld(const ThesisSettings& settings) {
  world::WorldSettings world;
  world.seconds = 24.0;
  world.threads = settings.threads;
  return world;
}

/// A world with the image size, focal length and baseline of KITTI, as in the thesis.
world::WorldSettings kittiLikeWorld(const ThesisSettings& settings) {
  world::WorldSettings world = depthWorld(settings);
  world.image_size = {1241, 376};
  world.focal_length = 718.9;
  world.baseline = 0.537;
  return world;
}

class ThesisRun {
 public:
  ThesisRun(const ThesisSettings& settings, const WorkObserver& observer)
      : settings_(settings), observer_(observer) {
    results_.features = settings.odometry.features;
    results_.many_features = settings.many_features;
  }

  void measureDepth(const std::string& rig, const world::WorldSettings& world) {
    observer_.begin({"depth, " + rig});
    results_.depth.push_back(
        {rig, measureDepths(world, settings_.depth_pairs, results_.features, observer_.progress)});
  }

  void measure(const Sequence& sequence) {
    observer_.begin({sequence.name + ": feature counts"});
    const vo::DetectionSettings& detection = settings_.odometry.detection;
    results_.counts.push_back(
        {sequence.name, countFeatures(sequence.folder, withFixedThreshold(detection), results_.features),
         countFeatures(sequence.folder, detection, results_.features)});
    for (const vo::Estimator estimator : {vo::Estimator::thesis, vo::Estimator::reprojection}) {
      const Replay replay = replayed(sequence, results_.features, estimator);
      results_.rates.push_back({sequence.name, estimator, rateErrors(replay, sequence.truth)});
    }
  }

  void measureTimes(const Sequence& sequence) {
    const Replay few = replayed(sequence, results_.features, settings_.odometry.estimator);
    const Replay many = replayed(sequence, results_.many_features, settings_.odometry.estimator);
    StageTimeResult times{sequence.name, few.rig.rig.left.size, 0.0, stageMedians(few), stageMedians(many)};
    constexpr double kMinRectificationTime = 0.1;  // ms; less means that the images are already rectified
    const double own = times.few.stage(vo::Stage::rectify);
    times.rectification_ms = own > kMinRectificationTime ? own : rectificationMs(times.image_size);
    results_.times.push_back(times);
  }

  ThesisResults releaseResults() { return std::move(results_); }

 private:
  Replay replayed(const Sequence& sequence, int features, vo::Estimator estimator) {
    observer_.begin({sequence.name + ": " + std::to_string(features) + " features, " +
                     daemon::nameOf(estimator, daemon::kEstimators)});
    ReplaySettings replay;
    replay.source = sequence.folder;
    replay.odometry = settings_.odometry;
    replay.odometry.features = features;
    replay.odometry.estimator = estimator;
    replay.alert_limits = pipeline::AlertLimits{1e6, 1e6, 1e6, 1e6};  // compares methods, whatever they state
    return replaySource(replay, [&](const pipeline::PairResult& result, std::size_t expected) {
      observer_.progress(static_cast<int>(result.sequence) + 1, static_cast<int>(expected));
    });
  }

  const ThesisSettings& settings_;
  const WorkObserver& observer_;
  ThesisResults results_;
};

}  // namespace

ThesisResults runThesisBenchmark(const ThesisSettings& settings, const WorkObserver& observer) {
  const std::vector<Sequence> sequences = realSequences(settings.data);  // errors before the long work
  ThesisRun run(settings, observer);
  run.measureDepth("KITTI's rig", kittiLikeWorld(settings));
  run.measureDepth("the cart's rig", depthWorld(settings));
  for (const Sequence& sequence : sequences)
    run.measure(sequence);
  const auto length = [](const Sequence& sequence) { return sequence.truth.left_camera.size(); };
  const auto longest =
      std::max_element(sequences.begin(), sequences.end(),
                       [&](const Sequence& a, const Sequence& b) { return length(a) < length(b); });
  if (longest != sequences.end()) run.measureTimes(*longest);
  return run.releaseResults();
}

}  // namespace cartvo::benchmark
