#pragma once

#include <filesystem>
#include <vector>

#include "tools/evaluate/motion_comparison.hpp"

namespace cartvo {

/// Reads true poses of the body for the messages of an odometry.csv. Times of KITTI rows are those of the
/// messages, row by row. A truth of the left camera, which KITTI rows are, is converted to the body with
/// rig.T_body_camera of the summary.json beside the odometry.csv. Throws std::runtime_error naming the file
/// and the reason.
Trajectory readBodyTruth(const std::filesystem::path& truth, const std::filesystem::path& odometry,
                         const std::vector<OdometryRow>& rows);

/// Reads the messages of an odometry.csv and compares them with a truth file, see readBodyTruth. `offset_ns`
/// is added to their instants. Throws std::runtime_error also if no message has a truth at its time.
std::vector<ComparedMessage> compareMessages(const std::filesystem::path& odometry,
                                             const std::filesystem::path& truth, std::int64_t offset_ns);

}  // namespace cartvo
