#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <vector>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// True poses of the cart's body at each pair of a replay, relative to the first known one; empty where the
/// truth is unknown.
using Truth = std::vector<std::optional<Eigen::Isometry3d>>;

/// Reads the truth as it is, see readTruth.
Trajectory readTruthRows(const std::filesystem::path& file);

/// Reads the truth of a replay: KITTI rows are poses of the left camera, one row per pair; rows of TUM and
/// EuRoC are poses of the body, interpolated at each pair's instant, as are those of a raw recording of KITTI
/// (`file` is its folder), see readKittiOxts. Throws std::runtime_error naming the file, also if the
/// number of KITTI rows is not the number of pairs.
Truth readTruth(const std::filesystem::path& file, const Replay& replay);

}  // namespace cartvo
