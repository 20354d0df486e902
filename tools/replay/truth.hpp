#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <vector>

#include "tools/replay/replay.hpp"

namespace cartvo {

/// True poses of the cart's body at each pair of a replay, relative to the first one that is known; nothing
/// where the truth says nothing.
using Truth = std::vector<std::optional<Eigen::Isometry3d>>;

/// Reads the truth of a replay: KITTI rows are poses of the left camera, a row per pair; TUM rows are poses
/// of the body, interpolated at each pair's instant. Throws std::runtime_error naming the file, also if
/// KITTI's rows are not as many as the pairs.
Truth readTruth(const std::filesystem::path& file, const Replay& replay);

}  // namespace cartvo
