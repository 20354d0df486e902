#pragma once

#include <filesystem>

#include "tools/trajectory/trajectory.hpp"

namespace cartvo {

/// The poses that the GPS and inertial unit of a raw recording of KITTI measured, as those of the rectified
/// camera 0 (left, grey; camera 2 is 6 cm beside it) in the world of the first pose of the unit. `folder` is
/// the recording or its subfolder oxts, with timestamps.txt and data/NUMBER.txt; calib_imu_to_velo.txt,
/// calib_velo_to_cam.txt and calib_cam_to_cam.txt lie in the recording or in the folder above it. Throws
/// std::runtime_error naming the file and what was expected.
Trajectory readKittiOxts(const std::filesystem::path& folder);

}  // namespace cartvo
