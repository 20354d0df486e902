#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include <opencv2/core/mat.hpp>

#include "calib/model/rig.hpp"
#include "tools/trajectory/trajectory.hpp"

// Cameras that jump between two directions, as on a kerb.

namespace cartvo::benchmark {

/// Images, rig and truth of cameras that jump.
struct Jumps {
  /// Image of a camera, turned and without the border that a turned camera does not see.
  std::function<cv::Mat(const cv::Mat& image, bool left, std::int64_t exposure_ns)> turned;
  calib::Rig rig;    ///< of these images
  Trajectory truth;  ///< of the turned left camera, relative to its first pose
};

/// Turns both cameras by 5 degrees about `axis` (a unit vector of the left camera's axes) and back, each
/// second. Each turns about its own centre, which is exact for the x axis, along the baseline; for others the
/// direction of the baseline is wrong by half the angle.
Jumps jumpsOf(const calib::Rig& rig, const Trajectory& truth, std::int64_t first_ns,
              const Eigen::Vector3d& axis);

}  // namespace cartvo::benchmark
