#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "tools/benchmark/robustness/disturbance.hpp"

// Both estimators on disturbed sequences.

namespace cartvo::benchmark {

struct RobustnessSettings {
  std::filesystem::path data;  ///< real sequences, see realSequences; empty: none
  std::vector<world::WorldSettings> worlds;
  std::vector<std::string> disturbances;  ///< names; "none" is always measured
  vo::OdometrySettings odometry;          ///< of both estimators
  pipeline::AlertLimits limits;           ///< of VALID messages, and above which they are counted
  std::filesystem::path cache;            ///< of rendered worlds
};

/// Errors of one estimator on one row.
struct DisturbedAccuracy {
  SequenceAccuracy accuracy;
  /// Translation errors (m) of the path between poses about a second apart, for each whole second of the
  /// sequence: a second without an estimate counts with its whole motion.
  std::vector<double> errors_per_second;

  double error() const;  ///< m, root mean square of errors_per_second
};

/// One disturbance of one sequence.
struct RobustnessRow {
  std::string sequence;
  Disturbance disturbance;
  DisturbedAccuracy reprojection, thesis;
  double untouched_error = 0.0;  ///< m, of `reprojection` on the untouched sequence

  /// Whether `estimator: reprojection` is worse than `estimator: thesis` by a VALID message above
  /// an alert limit; or, if both have as many, by more than chance (two standard deviations) in the errors of
  /// the same seconds or in the share of valid pairs, or by a new epoch that brings no more valid pairs. At
  /// gross faults only messages above a limit count.
  bool isWorse() const;
};

/// Errors of the replayed path over each whole second.
std::vector<double> errorsPerSecond(const Replay& replay, const SequenceTruth& truth);

/// Runs both estimators on each disturbance of each sequence. Throws as runAccuracyBenchmark.
std::vector<RobustnessRow> runRobustnessBenchmark(const RobustnessSettings& settings,
                                                  const WorkObserver& observer);

}  // namespace cartvo::benchmark
