// Runs both estimators on all disturbances of all sequences.
#include "tools/benchmark/robustness/robustness_benchmark.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "tools/evaluate/association.hpp"

namespace cartvo::benchmark {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kSignificance = 2.0;  // standard deviations

/// Whether the mean of `a` exceeds that of `b` by more than chance; both are of the same seconds.
bool exceeds(const std::vector<double>& a, const std::vector<double>& b) {
  const std::size_t count = std::min(a.size(), b.size());
  if (count < 2) return false;
  double sum = 0.0, square = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += a[i] - b[i];
    square += (a[i] - b[i]) * (a[i] - b[i]);
  }
  const auto n = static_cast<double>(count);
  const double mean = sum / n, variance = std::max(0.0, square / n - mean * mean) / (n - 1.0);
  return mean > kSignificance * std::sqrt(variance);
}

std::size_t validPairs(const SequenceAccuracy& accuracy) {
  return accuracy.pairs - std::min(accuracy.pairs, accuracy.invalid + 1);  // the first has no motion
}

/// Whether fewer pairs are valid by more than chance, their number being binomially distributed.
bool hasFewerValid(const SequenceAccuracy& a, const SequenceAccuracy& b) {
  const auto n = static_cast<double>(std::max<std::size_t>(b.pairs, 1));
  const double share = static_cast<double>(validPairs(b)) / n;
  const double stddev = std::sqrt(std::max(n * share * (1.0 - share), 1.0));
  return static_cast<double>(validPairs(a)) + kSignificance * stddev < static_cast<double>(validPairs(b));
}

class RobustnessRun {
 public:
  RobustnessRun(const RobustnessSettings& settings, const WorkObserver& observer)
      : settings_(settings), observer_(observer), worlds_(settings.cache / "worlds") {}

  void measure(const Sequence& sequence) {
    untouched_error_ = 0.0;
    add(sequence, disturbanceNamed("none"));
    untouched_error_ = rows_.back().reprojection.error();
    rows_.back().untouched_error = untouched_error_;
    for (const std::string& name : settings_.disturbances)
      if (name != "none" && !isRendered(sequence, name)) add(sequence, disturbanceNamed(name));
  }

  void measure(const world::WorldSettings& settings) {
    measure(render(settings));
    if (std::find(settings_.disturbances.begin(), settings_.disturbances.end(), "half-period") ==
        settings_.disturbances.end())
      return;
    world::WorldSettings late = settings;
    late.offset_s = 0.5 / settings.frame_rate;
    add(render(late), disturbanceNamed("none"));
    rows_.back().sequence = worldName(settings);
    rows_.back().disturbance = disturbanceNamed("half-period");
  }

  std::vector<RobustnessRow> releaseRows() { return std::move(rows_); }

 private:
  static bool isRendered(const Sequence& sequence, const std::string& disturbance) {
    return sequence.kind == SequenceKind::rendered && disturbance == "half-period";
  }

  Sequence render(const world::WorldSettings& settings) {
    observer_.begin({worldName(settings) + ": rendering, unless it is cached"});
    return renderedSequence(settings, worlds_, observer_.progress);
  }

  void add(const Sequence& sequence, const Disturbance& disturbance) {
    RobustnessRow row{sequence.name, disturbance, {}, {}, untouched_error_};
    row.reprojection = replayed(sequence, disturbance, vo::Estimator::reprojection);
    row.thesis = replayed(sequence, disturbance, vo::Estimator::thesis);
    rows_.push_back(std::move(row));
  }

  DisturbedAccuracy replayed(const Sequence& sequence, const Disturbance& disturbance,
                             vo::Estimator estimator) {
    DisturbedSequence played = disturbed(sequence, disturbance);
    vo::OdometrySettings odometry = settings_.odometry;
    odometry.estimator = estimator;
    observer_.begin({sequence.name + ", " + disturbance.name});
    const Replay replay = replayPairs(
        played.source, played.rig, odometry,
        [&](const pipeline::PairResult& result, std::size_t expected) {
          observer_.progress(static_cast<int>(result.sequence) + 1, static_cast<int>(expected));
        },
        {}, nullptr, settings_.limits);
    if (replay.pairs.empty()) return {};
    return {measureAccuracy(replay, played.truth, settings_.limits), errorsPerSecond(replay, played.truth)};
  }

  const RobustnessSettings& settings_;
  const WorkObserver& observer_;
  WorldCache worlds_;
  double untouched_error_ = 0.0;
  std::vector<RobustnessRow> rows_;
};

}  // namespace

double DisturbedAccuracy::error() const {
  double square = 0.0;
  for (const double error : errors_per_second)
    square += error * error;
  return errors_per_second.empty() ? 0.0 : std::sqrt(square / static_cast<double>(errors_per_second.size()));
}

bool RobustnessRow::isWorse() const {
  const SequenceAccuracy &a = reprojection.accuracy, &b = thesis.accuracy;
  const std::size_t above = a.validity.above_limit, above_of_thesis = b.validity.above_limit;
  if (above != above_of_thesis || disturbance.kind == DisturbanceKind::rig) return above > above_of_thesis;
  if (hasFewerValid(a, b)) return true;
  if (a.resets > b.resets && validPairs(a) <= validPairs(b)) return true;
  return exceeds(reprojection.errors_per_second, thesis.errors_per_second);
}

std::vector<double> errorsPerSecond(const Replay& replay, const SequenceTruth& truth) {
  const auto [method, estimate, exact, unmatched] =
      associateByTime(leftCameraTrajectory(replay), truth.left_camera);
  std::vector<double> errors;
  for (std::size_t from = 0, to = 0; from < exact.size(); from = to) {
    while (to < exact.size() && exact[to].time_ns < exact[from].time_ns + kSecond_ns)
      ++to;
    if (to == exact.size()) break;
    const Eigen::Isometry3d estimated = estimate[from].pose.inverse() * estimate[to].pose;
    const Eigen::Isometry3d true_motion = exact[from].pose.inverse() * exact[to].pose;
    errors.push_back((true_motion.inverse() * estimated).translation().norm());
  }
  return errors;
}

std::vector<RobustnessRow> runRobustnessBenchmark(const RobustnessSettings& settings,
                                                  const WorkObserver& observer) {
  RobustnessRun run(settings, observer);
  for (const Sequence& sequence : realSequences(settings.data))
    run.measure(sequence);
  for (const world::WorldSettings& world : settings.worlds)
    run.measure(world);
  return run.releaseRows();
}

}  // namespace cartvo::benchmark
