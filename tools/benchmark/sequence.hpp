#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/benchmark/world_cache.hpp"
#include "tools/trajectory/trajectory.hpp"
#include "tools/world/world_settings.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::benchmark {

enum class SequenceKind : std::uint8_t {
  real,      ///< pictures of real cameras; the truth is a reference with errors of its own
  rendered,  ///< the truth is exact
};

/// Where the cameras truly were.
struct SequenceTruth {
  Trajectory left_camera;  ///< its own axes, relative to the first; a pose at each left instant
  /// Of the body's origin at the same instants, (m/s, rad/s) in body axes as BodyMotion's; empty where the
  /// truth does not tell it (poses alone do not).
  std::vector<Vector6d> body_twist;
};

/// Pictures on disk to measure the odometry with.
struct Sequence {
  std::string name;
  SequenceKind kind = SequenceKind::real;
  std::filesystem::path folder;  ///< what `cartvo replay` takes
  SequenceTruth truth;
};

/// The image folders in `data` (KITTI's or EuRoC's layout), by name. Truth is poses.txt (KITTI rows); a
/// folder whose name ends in "_still" stands still; others are left out. None if `data` is an empty path.
/// Throws std::runtime_error naming the folder if there is none in it, or the file if one of them is
/// contradictory.
std::vector<Sequence> realSequences(const std::filesystem::path& data);

/// A rendered world, from the cache or rendered into it.
Sequence renderedSequence(const world::WorldSettings& settings, const WorldCache& cache,
                          const simulate::Progress& progress);

/// "campus 1", "campus 1 +12 ms +50 ppm": scenario, seed, offset of the right camera and its clock's drift.
std::string worldName(const world::WorldSettings& settings);

}  // namespace cartvo::benchmark
