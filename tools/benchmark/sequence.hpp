#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lab/render/world_settings.hpp"
#include "tools/benchmark/world_cache.hpp"
#include "tools/benchmark/world_sets.hpp"
#include "tools/trajectory/trajectory.hpp"
#include "vo_core/rigid_motion.hpp"

namespace cartvo::benchmark {

/// Origin of the images of a sequence.
enum class SequenceKind : std::uint8_t {
  real,      ///< real cameras; the truth is a reference with errors of its own
  rendered,  ///< rendered world with exact truth
};

/// The true motion of the cameras.
struct SequenceTruth {
  Trajectory left_camera;  ///< in its own axes, relative to the first pose; one pose per left instant
  /// Twist of the body origin at the same instants, (m/s, rad/s) in body axes as in BodyMotion; empty if the
  /// truth consists of poses only.
  std::vector<vo::Vector6d> body_twist;
  bool has_jumps = false;  ///< the poses are not those of a motion, so that they have no velocity
};

/// A sequence of image pairs on disk with its ground truth.
struct Sequence {
  std::string name;
  SequenceKind kind = SequenceKind::real;
  std::filesystem::path folder;  ///< in a layout that `cartvo replay` reads
  SequenceTruth truth;
  std::optional<WorldSet> set;  ///< of a rendered world; nothing: of neither set
};

/// The image folders in `data` (of any layout that readImageFolder reads) with a ground truth, sorted by
/// name. The truth is poses.txt (KITTI rows); a folder whose name ends in "_still" is a standstill; other
/// folders are left out. Returns nothing if `data` is an empty path. Throws std::runtime_error naming the
/// folder if it contains no sequence, or naming the file if its poses do not match the images.
std::vector<Sequence> realSequences(const std::filesystem::path& data);

/// The rendered world of `settings`, read from the cache or rendered into it.
Sequence renderedSequence(const world::WorldSettings& settings, const WorldCache& cache,
                          const simulate::Progress& progress);

/// Scenario, seed, time offset and clock drift of the right camera, readouts and vibration as text: "campus
/// 1", "campus 1 +12 ms +50 ppm", "campus 1, readout 32/38 ms, shaken at 8 Hz".
std::string worldName(const world::WorldSettings& settings);

}  // namespace cartvo::benchmark
