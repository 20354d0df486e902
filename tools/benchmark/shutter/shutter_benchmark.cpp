// Measures drives with rolling shutters and a shaken mount, with and without modelling the readout.
#include "tools/benchmark/shutter/shutter_benchmark.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "daemon/service/configuration_names.hpp"
#include "tools/benchmark/accuracy/true_motion.hpp"
#include "tools/benchmark/grouping.hpp"

namespace cartvo::benchmark {
namespace {

constexpr std::array<std::pair<ReadoutModel, const char*>, 3> kModels{{{ReadoutModel::known, "known"},
                                                                       {ReadoutModel::estimated, "estimated"},
                                                                       {ReadoutModel::ignored, "ignored"}}};

/// The rig as the odometry gets it; the rig of a rendered world states the true readouts.
calib::Rig rigFor(ReadoutModel model, calib::Rig rig) {
  for (calib::CameraModel* camera : {&rig.left, &rig.right}) {
    if (model == ReadoutModel::ignored) camera->readout = 0.0;
    if (model == ReadoutModel::estimated) camera->readout.reset();
  }
  return rig;
}

world::WorldSettings seenAs(world::WorldSettings world, const ShutterCase& seen) {
  world.left_readout = seen.readout.left;
  world.right_readout = seen.readout.right;
  world.offset_s = seen.clock.offset_s;
  world.offset_drift_ppm = seen.clock.drift_ppm;
  world.shake = seen.shake;
  return world;
}

ShutterAccuracy measure(const Sequence& sequence, ReadoutModel model, const ShutterSettings& settings,
                        const WorkObserver& observer) {
  observer.begin({sequence.name + ": readout " + readoutModelName(model)});
  capture::StereoSource source = capture::openSource(sequence.folder);
  pipeline::FoundRig rig = pipeline::findRig(source, sequence.folder, {});
  rig.rig = rigFor(model, std::move(rig.rig));
  const Replay replay = replayPairs(
      source, rig, settings.odometry,
      [&](const pipeline::PairResult& result, std::size_t expected) {
        observer.progress(static_cast<int>(result.sequence) + 1, static_cast<int>(expected));
      },
      pipeline::AbsentReadout::unknown, nullptr, settings.limits);
  if (replay.pairs.empty())
    throw std::runtime_error(
        sequence.name + ": no left and right image could be paired; check the timestamps of both cameras");
  ShutterAccuracy result;
  result.model = model;
  result.accuracy = measureAccuracy(replay, sequence.truth, settings.limits);
  result.accuracy.kind = sequence.kind;
  result.accuracy.estimator = daemon::nameOf(settings.odometry.estimator, daemon::kEstimators);
  result.rates = AngularRateErrors(replay, sequence.truth);
  return result;
}

}  // namespace

std::string readoutModelName(ReadoutModel model) {
  for (const auto& [value, name] : kModels)
    if (value == model) return name;
  throw std::invalid_argument("unknown value of ReadoutModel");
}

std::vector<std::string> readoutModelNames() {
  std::vector<std::string> names;
  for (const auto& [value, name] : kModels)
    names.emplace_back(name);
  return names;
}

ReadoutModel readoutModelNamed(const std::string& wanted) {
  for (const auto& [value, name] : kModels)
    if (name == wanted) return value;
  throw std::invalid_argument("unknown readout model '" + wanted + "'; expected known, estimated or ignored");
}

bool isMeasured(const ShutterCase& seen, ReadoutModel model) {
  if (seen.readout.isGlobal()) return model == ReadoutModel::known;
  return model != ReadoutModel::estimated || (seen.readout.left > 0.0 && seen.readout.right > 0.0);
}

AngularRateErrors::AngularRateErrors(const Replay& replay, const SequenceTruth& truth) {
  const TruthRows rows(replay, truth.left_camera);
  for (std::size_t index = 0; index < replay.pairs.size(); ++index) {
    const ReplayedPair& pair = replay.pairs[index];
    const std::optional<std::size_t> row = rows.at(index);
    if (!pair.valid || !row || truth.body_twist.empty() || !pair.angular_velocity.allFinite()) continue;
    const Eigen::Vector3d rate = truth.body_twist[*row].tail<3>();
    errors_ += (pair.angular_velocity - rate).squaredNorm();
    rates_ += rate.squaredNorm();
    ++count_;
  }
}

void AngularRateErrors::add(const AngularRateErrors& other) {
  errors_ += other.errors_;
  rates_ += other.rates_;
  count_ += other.count_;
}

double AngularRateErrors::relative() const {
  return std::sqrt(errors_ / rates_);
}

ShutterAccuracy summarise(const std::string& name, const std::vector<ShutterAccuracy>& results) {
  ShutterAccuracy all{name, results.front().seen, results.front().model, {}, {}};
  std::vector<SequenceAccuracy> accuracies;
  for (const ShutterAccuracy& one : results) {
    accuracies.push_back(one.accuracy);
    all.rates.add(one.rates);
  }
  all.accuracy = summarise(name, accuracies);
  return all;
}

std::vector<ShutterAccuracy> runShutterBenchmark(const ShutterSettings& settings,
                                                 const WorkObserver& observer) {
  const WorldCache worlds(settings.cache / "worlds");
  std::vector<ShutterAccuracy> results;
  for (const world::WorldSettings& world : settings.worlds) {
    for (const ShutterCase& seen : settings.cases) {
      const world::WorldSettings rendered = seenAs(world, seen);
      observer.begin({worldName(rendered) + ": rendering, unless it is cached"});
      const Sequence sequence = renderedSequence(rendered, worlds, observer.progress);
      for (const ReadoutModel model : settings.models) {
        if (!isMeasured(seen, model)) continue;
        results.push_back(measure(sequence, model, settings, observer));
        results.back().sequence = world::driveName(world);
        results.back().seen = seen;
      }
    }
  }
  const auto are_seeds = [](const ShutterAccuracy& a, const ShutterAccuracy& b) {
    return a.sequence == b.sequence && a.seen == b.seen && a.model == b.model;
  };
  std::vector<ShutterAccuracy> scenarios;
  for (const std::vector<ShutterAccuracy>& seeds : grouped(results, are_seeds))
    scenarios.push_back(summarise(seeds.front().sequence, seeds));
  return scenarios;
}

}  // namespace cartvo::benchmark
