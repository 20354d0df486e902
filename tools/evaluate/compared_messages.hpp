#pragma once

#include <filesystem>
#include <vector>

#include "tools/evaluate/motion_comparison.hpp"

namespace cartvo {

/// Reads the messages of an odometry.csv and compares them with a truth file. Times of KITTI rows are those
/// of the messages, row by row. A truth of the left camera, which KITTI rows are, is converted to the body
/// with rig.T_body_camera of the summary.json beside the odometry.csv. Throws std::runtime_error naming the
/// file and the reason.
std::vector<ComparedMessage> compareMessages(const std::filesystem::path& odometry,
                                             const std::filesystem::path& truth);

}  // namespace cartvo
