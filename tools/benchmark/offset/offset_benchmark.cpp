// Measures drives with several time offsets of the right camera, with and without modelling the offset.
#include "tools/benchmark/offset/offset_benchmark.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "daemon/service/configuration_names.hpp"
#include "tools/benchmark/offset/alternate_frames.hpp"
#include "tools/benchmark/simultaneous.hpp"

namespace cartvo::benchmark {
namespace {

constexpr double kCrystalSkew = 50.0;  // ppm, typical of two crystals

constexpr std::array<std::pair<OffsetModel, const char*>, 2> kModels{
    {{OffsetModel::two_instants, "two-instants"}, {OffsetModel::simultaneous, "simultaneous"}}};

bool isMoving(const Sequence& sequence) {
  constexpr double kMinDistance = 1.0;  // m
  return sequence.truth.left_camera.back().pose.translation().norm() > kMinDistance;
}

/// Measures worlds and real sequences, and groups the results of all seeds of a scenario.
class OffsetRun {
 public:
  OffsetRun(const OffsetSettings& settings, const WorkObserver& observer)
      : settings_(settings), observer_(observer), worlds_(settings.cache / "worlds") {}

  void measureWorld(world::WorldSettings world, const RightClock& clock) {
    world.offset_s = clock.offset_s;
    world.offset_drift_ppm = clock.drift_ppm;
    observer_.begin({worldName(world) + ": rendering, unless it is cached"});
    const Sequence sequence = renderedSequence(world, worlds_, observer_.progress);
    for (const OffsetModel model : settings_.models) {
      capture::StereoSource source = model == OffsetModel::simultaneous
                                         ? openSimultaneous(sequence.folder)
                                         : capture::openSource(sequence.folder);
      add(world::driveName(world), clock, model, measure(sequence, source, model, settings_.odometry));
    }
  }

  void measureReal(Sequence sequence) {
    const std::string name = sequence.name + ", every 2nd frame";
    const Trajectory& all = sequence.truth.left_camera;
    const double period = 1e-9 * static_cast<double>(all[1].time_ns - all[0].time_ns);
    sequence.truth = alternate(sequence.truth);
    vo::OdometrySettings odometry = settings_.odometry;
    odometry.validity.maximum_offset = std::max(odometry.validity.maximum_offset, 1.5 * period);
    for (const RightFrames right : {RightFrames::same, RightFrames::next}) {
      const RightClock clock{right == RightFrames::next ? period : 0.0, 0.0};
      for (const OffsetModel model : settings_.models) {
        capture::StereoSource source =
            openAlternate(sequence.folder, right, model == OffsetModel::simultaneous);
        add(name, clock, model, measure(sequence, source, model, odometry));
      }
    }
  }

  std::vector<OffsetAccuracy> summarisedResults() {
    std::vector<OffsetAccuracy> results;
    for (Group& group : groups_) {
      group.result.accuracy = summarise(group.result.sequence, group.seeds);
      results.push_back(std::move(group.result));
    }
    return results;
  }

 private:
  struct Group {
    OffsetAccuracy result;
    std::vector<SequenceAccuracy> seeds;
  };

  SequenceAccuracy measure(const Sequence& sequence, capture::StereoSource& source, OffsetModel model,
                           const vo::OdometrySettings& odometry) {
    observer_.begin({sequence.name + ": " + offsetModelName(model)});
    const pipeline::FoundRig rig = pipeline::findRig(source, sequence.folder, {});
    const Replay replay = replayPairs(
        source, rig, odometry,
        [&](const pipeline::PairResult& result, std::size_t expected) {
          observer_.progress(static_cast<int>(result.sequence) + 1, static_cast<int>(expected));
        },
        {}, nullptr, settings_.limits);
    if (replay.pairs.empty())
      throw std::runtime_error(
          sequence.name + ": no left and right image could be paired; check the timestamps of both cameras");
    SequenceAccuracy accuracy = measureAccuracy(replay, sequence.truth, settings_.limits);
    accuracy.sequence = sequence.name;
    accuracy.kind = sequence.kind;
    accuracy.estimator = daemon::nameOf(odometry.estimator, daemon::kEstimators);
    return accuracy;
  }

  void add(const std::string& sequence, const RightClock& clock, OffsetModel model,
           SequenceAccuracy accuracy) {
    const auto same = std::find_if(groups_.begin(), groups_.end(), [&](const Group& group) {
      return group.result.sequence == sequence && group.result.clock == clock && group.result.model == model;
    });
    if (same == groups_.end()) {
      groups_.push_back({{sequence, clock, model, {}}, {std::move(accuracy)}});
    } else {
      same->seeds.push_back(std::move(accuracy));
    }
  }

  const OffsetSettings& settings_;
  const WorkObserver& observer_;
  WorldCache worlds_;
  std::vector<Group> groups_;
};

}  // namespace

RightClock slowSweep(const world::WorldSettings& world) {
  return {0.5 / world.frame_rate - 0.5e-6 * kCrystalSkew * world.seconds, kCrystalSkew};
}

RightClock fastSweep(const world::WorldSettings& world) {
  const double period = 1.0 / world.frame_rate;
  return {-0.25 * period, 1e6 * period / world.seconds};
}

std::string offsetModelName(OffsetModel model) {
  for (const auto& [value, name] : kModels)
    if (value == model) return name;
  throw std::invalid_argument("unknown value of OffsetModel");
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
  throw std::invalid_argument("unknown offset model '" + wanted + "'; expected two-instants or simultaneous");
}

std::vector<OffsetAccuracy> runOffsetBenchmark(const OffsetSettings& settings, const WorkObserver& observer) {
  const std::vector<Sequence> real = realSequences(settings.data);  // errors before the long work
  OffsetRun run(settings, observer);
  for (const world::WorldSettings& world : settings.worlds) {
    for (const RightClock& clock : settings.clocks)
      run.measureWorld(world, clock);
  }
  for (const Sequence& sequence : real)
    if (isMoving(sequence)) run.measureReal(sequence);
  return run.summarisedResults();
}

}  // namespace cartvo::benchmark
