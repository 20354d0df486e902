#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy_benchmark.hpp"

namespace cartvo::benchmark {

/// How the right camera's exposures lie against the left one's.
struct RightClock {
  double offset_s = 0.0;   ///< right minus left instant at the start
  double drift_ppm = 0.0;  ///< the right camera's period is longer by this, 1e-6

  bool operator==(const RightClock&) const = default;
};

/// What crystals differ by in the field: 50 ppm, around half a frame period, which the offset crosses in the
/// middle of the drive. From then on each image has another partner, and the other camera is the earlier one.
RightClock slowSweep(const world::WorldSettings& world);

/// All offsets there are within the drive: from a quarter of a period before, through zero after a quarter of
/// the drive, through half a period after three quarters.
RightClock fastSweep(const world::WorldSettings& world);

/// What the odometry is told of the time between a pair's two exposures.
enum class OffsetModel : std::uint8_t {
  two_instants,  ///< both instants, as in the product
  simultaneous,  ///< the left instant for both: the error that other odometries make
};

/// "two-instants", "simultaneous".
std::string offsetModelName(OffsetModel model);
std::vector<std::string> offsetModelNames();
/// The reverse. Throws std::invalid_argument.
OffsetModel offsetModelNamed(const std::string& name);

/// What is measured with what.
struct OffsetSettings {
  std::filesystem::path data;                ///< real sequences, see realSequences; empty: none
  std::vector<world::WorldSettings> worlds;  ///< their right cameras' clocks are those of `clocks`
  std::vector<RightClock> clocks;
  std::vector<OffsetModel> models;
  OdometrySettings odometry;
  std::filesystem::path cache;  ///< for rendered worlds
};

/// What one model made of one sequence with one clock.
struct OffsetAccuracy {
  std::string sequence;  ///< a scenario, all its seeds together; or a real sequence
  RightClock clock;
  OffsetModel model = OffsetModel::two_instants;
  SequenceAccuracy accuracy;  ///< see summarise
};

/// Each world with each clock by each model, through the daemon's pipeline; then each real sequence that
/// moves at half its rate, with the right images of the same instants and with those between. Throws what
/// sequences and settings are refused for.
std::vector<OffsetAccuracy> runOffsetBenchmark(const OffsetSettings& settings, const WorkObserver& observer);

}  // namespace cartvo::benchmark
