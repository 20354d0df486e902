// The same drives, the right camera exposed ever later, with and without what is made of it.
#include "tools/benchmark/offset_benchmark.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tools/benchmark/alternate_frames.hpp"
#include "tools/benchmark/simultaneous.hpp"
#include "tools/replay/setting_names.hpp"

namespace cartvo::benchmark {
namespace {

constexpr double kCrystals = 50.0;  // ppm

constexpr std::array<std::pair<OffsetModel, const char*>, 2> kModels{
    {{OffsetModel::two_instants, "two-instants"}, {OffsetModel::simultaneous, "simultaneous"}}};

bool moves(const Sequence& sequence) {
  constexpr double kMoves = 1.0;  // m
  return sequence.truth.left_camera.back().pose.translation().norm() > kMoves;
}

/// Measures what is asked for and keeps it, the seeds of a scenario together.
class OffsetRun {
 public:
  OffsetRun(const OffsetSettings& settings, const WorkObserver& observer)
      : settings_(settings), observer_(observer), worlds_(settings.cache / "worlds") {}

  void measureWorld(world::WorldSettings world, const RightClock& clock) {
    world.offset_s = clock.offset_s;
    world.offset_drift_ppm = clock.drift_ppm;
    observer_.begin(worldName(world) + ": rendering, unless it is cached");
    const Sequence sequence = renderedSequence(world, worlds_, observer_.progress);
    for (const OffsetModel model : settings_.models) {
      StereoSource source = model == OffsetModel::simultaneous ? openSimultaneous(sequence.folder)
                                                               : openSource(sequence.folder);
      keep(std::string(world::scenarioName(world.scenario)), clock, model,
           measured(sequence, source, model, settings_.odometry));
    }
  }

  void measureReal(Sequence sequence) {
    const std::string name = sequence.name + ", every 2nd frame";
    const Trajectory& all = sequence.truth.left_camera;
    const double period = 1e-9 * static_cast<double>(all[1].time_ns - all[0].time_ns);
    sequence.truth = alternate(sequence.truth);
    OdometrySettings odometry = settings_.odometry;
    odometry.validity.maximum_offset = std::max(odometry.validity.maximum_offset, 1.5 * period);
    for (const RightFrames right : {RightFrames::same, RightFrames::next}) {
      const RightClock clock{right == RightFrames::next ? period : 0.0, 0.0};
      for (const OffsetModel model : settings_.models) {
        StereoSource source = openAlternate(sequence.folder, right, model == OffsetModel::simultaneous);
        keep(name, clock, model, measured(sequence, source, model, odometry));
      }
    }
  }

  std::vector<OffsetAccuracy> take() {
    std::vector<OffsetAccuracy> results;
    for (Kept& kept : kept_) {
      kept.result.accuracy = summarise(kept.result.sequence, kept.seeds);
      results.push_back(std::move(kept.result));
    }
    return results;
  }

 private:
  struct Kept {
    OffsetAccuracy result;
    std::vector<SequenceAccuracy> seeds;
  };

  SequenceAccuracy measured(const Sequence& sequence, StereoSource& source, OffsetModel model,
                            const OdometrySettings& odometry) {
    observer_.begin(sequence.name + ": " + offsetModelName(model));
    const FoundRig rig = findRig(source, sequence.folder, {});
    const Replay replay =
        replayPairs(source, rig, odometry, [&](const PairResult& result, std::size_t expected) {
          observer_.progress(static_cast<int>(result.sequence) + 1, static_cast<int>(expected));
        });
    if (replay.pairs.empty())
      throw std::runtime_error(sequence.name + ": holds no pair of images that belong together");
    SequenceAccuracy accuracy = measureAccuracy(replay, sequence.truth);
    accuracy.sequence = sequence.name;
    accuracy.kind = sequence.kind;
    accuracy.estimator = estimatorName(odometry.estimator);
    return accuracy;
  }

  void keep(const std::string& sequence, const RightClock& clock, OffsetModel model,
            SequenceAccuracy accuracy) {
    const auto same = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
      return kept.result.sequence == sequence && kept.result.clock == clock && kept.result.model == model;
    });
    if (same == kept_.end()) {
      kept_.push_back({{sequence, clock, model, {}}, {std::move(accuracy)}});
    } else {
      same->seeds.push_back(std::move(accuracy));
    }
  }

  const OffsetSettings& settings_;
  const WorkObserver& observer_;
  WorldCache worlds_;
  std::vector<Kept> kept_;
};

}  // namespace

RightClock slowSweep(const world::WorldSettings& world) {
  return {0.5 / world.frame_rate - 0.5e-6 * kCrystals * world.seconds, kCrystals};
}

RightClock fastSweep(const world::WorldSettings& world) {
  const double period = 1.0 / world.frame_rate;
  return {-0.25 * period, 1e6 * period / world.seconds};
}

std::string offsetModelName(OffsetModel model) {
  for (const auto& [value, name] : kModels)
    if (value == model) return name;
  throw std::invalid_argument("no offset model");
}

std::vector<std::string> offsetModelNames() {
  std::vector<std::string> names;
  for (const auto& [value, name] : kModels)
    names.emplace_back(name);
  return names;
}

OffsetModel offsetModelNamed(const std::string& wanted) {
  for (const auto& [value, name] : kModels)
    if (name == wanted) return value;
  throw std::invalid_argument("there is no offset model '" + wanted + "'");
}

std::vector<OffsetAccuracy> runOffsetBenchmark(const OffsetSettings& settings, const WorkObserver& observer) {
  const std::vector<Sequence> real = realSequences(settings.data);  // fails, if it does, before the work
  OffsetRun run(settings, observer);
  for (const world::WorldSettings& world : settings.worlds) {
    for (const RightClock& clock : settings.clocks)
      run.measureWorld(world, clock);
  }
  for (const Sequence& sequence : real)
    if (moves(sequence)) run.measureReal(sequence);
  return run.take();
}

}  // namespace cartvo::benchmark
