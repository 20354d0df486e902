#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy.hpp"
#include "tools/world/world_settings.hpp"
#include "vo_core/odometry_settings.hpp"

namespace cartvo::benchmark {

/// A way to set the odometry, and what tables call it.
struct OdometryVariant {
  std::string name;
  OdometrySettings odometry;
  bool simultaneous = false;  ///< right images get the instants of the left ones; not of encoded runs
};

/// What is measured with what.
struct AccuracySettings {
  std::filesystem::path data;  ///< real sequences, see realSequences; empty: none
  std::vector<world::WorldSettings> worlds;
  std::vector<OdometryVariant> variants;
  std::vector<double> bitrates_mbps;  ///< further runs over H.264 of these rates, each camera's
  std::filesystem::path cache;        ///< for rendered worlds and encoded streams
};

/// Is told what goes on: each piece of work as it begins, then how far it is.
struct WorkObserver {
  std::function<void(const std::string& what)> begin;
  simulate::Progress progress;
};

/// Runs each variant over each sequence through the daemon's pipeline, as `cartvo replay` does: sequence by
/// sequence, of each first its pictures as they are, then encoded at each bit rate. Throws what sequences and
/// settings are refused for.
std::vector<SequenceAccuracy> runAccuracyBenchmark(const AccuracySettings& settings,
                                                   const WorkObserver& observer);

}  // namespace cartvo::benchmark
