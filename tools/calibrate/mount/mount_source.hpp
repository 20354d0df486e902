#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "calib/model/rig.hpp"
#include "tools/calibrate/mount/mount.hpp"

namespace cartvo::calibrate {

/// Measurements for measureMount from a source, in the axes of the rig's left camera.
struct MountMeasurements {
  std::vector<GroundObservation> ground;
  std::vector<CameraTwist> motions;
  std::size_t pairs = 0;
  std::size_t unsynchronised =
      0;  ///< pairs not searched for the ground, since the cart moved between the exposures
};

/// Called with the number of pairs processed and the number expected (0: unknown).
using MountProgress = std::function<void(std::size_t done, std::size_t expected)>;

/// Runs the odometry over a recording or a folder of images, and searches for the ground some times a second,
/// in pairs between whose exposures the cart moves less than a millimetre. Throws std::runtime_error for a
/// source without pairs, and the exceptions of openSource and of the rectification.
MountMeasurements collectMountMeasurements(const std::filesystem::path& source, const calib::Rig& rig,
                                           const MountProgress& progress);

}  // namespace cartvo::calibrate
