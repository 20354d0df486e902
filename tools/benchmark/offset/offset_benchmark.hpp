#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/benchmark/accuracy/accuracy_benchmark.hpp"

namespace cartvo::benchmark {

/// The exposure instants of the right camera relative to the left camera.
struct RightClock {
  double offset_s = 0.0;   ///< right minus left instant at the start
  double drift_ppm = 0.0;  ///< relative excess of the right frame period, 1e-6

  bool operator==(const RightClock&) const = default;
};

/// A drift of 50 ppm, as between two crystals in the field. The offset crosses half a frame period in the
/// middle of the drive; from there on another partner is the nearer one, but each image keeps its own
/// (capture::PairSynchroniser).
RightClock slowSweep(const world::WorldSettings& world);

/// A drift through all possible offsets within the drive: from minus a quarter of a frame period, through
/// zero after a quarter of the drive and through half a period after three quarters.
RightClock fastSweep(const world::WorldSettings& world);

/// The instants that the odometry gets for the two images of a pair.
enum class OffsetModel : std::uint8_t {
  two_instants,  ///< both exposure instants, as in cartvod
  simultaneous,  ///< the left instant for both images, as in other stereo odometries
};

/// Returns "two-instants" or "simultaneous".
std::string offsetModelName(OffsetModel model);
std::vector<std::string> offsetModelNames();
/// The model of that name. Throws std::invalid_argument if there is none.
OffsetModel offsetModelNamed(const std::string& name);

/// Sequences, clocks and models of an offset benchmark.
struct OffsetSettings {
  std::filesystem::path data;                ///< real sequences, see realSequences; empty: none
  std::vector<world::WorldSettings> worlds;  ///< rendered with each of `clocks`
  std::vector<RightClock> clocks;
  std::vector<OffsetModel> models;
  vo::OdometrySettings odometry;
  pipeline::AlertLimits limits;  ///< of VALID messages, and above which they are counted
  std::filesystem::path cache;   ///< for rendered worlds
};

/// The accuracy of one model on one sequence with one clock.
struct OffsetAccuracy {
  std::string sequence;  ///< a scenario with all its seeds, or a real sequence
  RightClock clock;
  OffsetModel model = OffsetModel::two_instants;
  SequenceAccuracy accuracy;  ///< see summarise
};

/// Measures each world with each clock and model through the daemon's pipeline, then each moving real
/// sequence at half its rate, with the right images of the same instants and with the images in between.
/// Throws std::runtime_error naming a sequence that cannot be used, std::invalid_argument for invalid
/// settings.
std::vector<OffsetAccuracy> runOffsetBenchmark(const OffsetSettings& settings, const WorkObserver& observer);

}  // namespace cartvo::benchmark
