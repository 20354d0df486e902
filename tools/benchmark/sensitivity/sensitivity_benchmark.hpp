#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"
#include "vo_core/tuned_constants.hpp"

namespace cartvo::benchmark {

/// Sequences and constants of a sensitivity benchmark.
struct SensitivitySettings {
  AccuracySettings sequences;          ///< its variants are replaced
  vo::OdometrySettings odometry;       ///< with which the others are compared
  std::vector<std::string> constants;  ///< names of vo::tunedConstants()
  double factor = 1.3;                 ///< above 1: each constant is divided and multiplied by it
  int threads = 2;                     ///< runs at a time
};

/// Results of one run relative to those with the default settings, over all sequences.
struct RelativeResult {
  // Geometric means of the ratios of the sequences, as natural logarithms.
  double segments = 0.0;  ///< errors of segments, translation and rotation
  double relative = 0.0;  ///< errors from pair to pair, translation and rotation
  double nees = 0.0;      ///< normalised errors of motions
  int invalid = 0;        ///< additional invalid pairs
  int above_limit = 0;    ///< additional VALID messages above an alert limit
};

/// Results of a constant below and above its default value; empty if its range does not permit the change.
struct ConstantSensitivity {
  const vo::TunedConstant* constant = nullptr;
  double default_value = 0.0, low_value = 0.0, high_value = 0.0;
  std::optional<RelativeResult> low, high;
  double effect = 0.0;  ///< the largest change, in multiples of Sensitivity::chance
};

struct Sensitivity {
  std::vector<ConstantSensitivity> constants;  ///< the largest effect first
  /// The largest changes by chance: other random subsets and slightly different numbers of landmarks.
  RelativeResult chance;
  std::size_t pairs = 0;  ///< of one run
};

/// The settings with the constant at `value`, rounded, moved by at least one if it is an integer, and within
/// its range; empty if that is the default value or not permitted together with the other settings.
std::optional<vo::OdometrySettings> withConstant(const vo::TunedConstant& constant, double value,
                                                 const vo::OdometrySettings& settings);

/// Compares results on the same sequences in the same order.
RelativeResult relativeTo(const std::vector<SequenceAccuracy>& reference,
                          const std::vector<SequenceAccuracy>& changed);

/// Runs all variants. Throws std::invalid_argument for an unknown constant, and as runAccuracyBenchmark does.
Sensitivity runSensitivityBenchmark(const SensitivitySettings& settings, const WorkObserver& observer);

}  // namespace cartvo::benchmark
