#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy/accuracy.hpp"
#include "tools/cartvo/work_observer.hpp"
#include "tools/world/world_settings.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo::benchmark {

/// Odometry settings with the name that tables show.
struct OdometryVariant {
  std::string name;
  vo::OdometrySettings odometry;
  bool simultaneous = false;  ///< give right images the left instants; encoded runs ignore it
};

/// Sequences, variants and bit rates of an accuracy benchmark.
struct AccuracySettings {
  std::filesystem::path data;  ///< real sequences, see realSequences; empty: none
  std::vector<world::WorldSettings> worlds;
  std::vector<OdometryVariant> variants;
  pipeline::AlertLimits limits;       ///< of VALID messages, and above which they are counted
  std::vector<double> bitrates_mbps;  ///< additional runs over H.264 at these rates per camera
  std::filesystem::path cache;        ///< for rendered worlds and encoded streams
  std::optional<std::size_t> only;    ///< index in sequenceNames of the one sequence to measure; empty: all
};

/// Names of the sequences in the order of the results. Each can be measured on its own
/// (AccuracySettings::only). Throws as runAccuracyBenchmark does.
std::vector<std::string> sequenceNames(const AccuracySettings& settings);

/// Runs each variant on each sequence through the daemon's pipeline, as `cartvo replay` does. The results are
/// ordered by sequence; for each sequence the lossless runs come first, then those of each bit rate. Throws
/// std::runtime_error naming a sequence that cannot be used, std::invalid_argument for invalid settings.
std::vector<SequenceAccuracy> runAccuracyBenchmark(const AccuracySettings& settings,
                                                   const WorkObserver& observer);

}  // namespace cartvo::benchmark
