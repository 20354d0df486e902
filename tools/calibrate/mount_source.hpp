#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "calib/rig.hpp"
#include "tools/calibrate/mount.hpp"

namespace cartvo::calibrate {

/// What a source shows of how its cameras are mounted, in the axes of the rig's left camera.
struct MountEvidence {
  std::vector<GroundSighting> sightings;
  std::vector<CameraTwist> motions;
  std::size_t pairs = 0;
  std::size_t apart = 0;  ///< pairs whose right image came too much later for a look at the ground
};

/// Is told how many pairs are done, and how many are expected (0: unknown).
using MountProgress = std::function<void(std::size_t done, std::size_t expected)>;

/// Runs the odometry over a recording or a folder of images, and looks for the ground some times a second.
/// Where the right image is exposed later, the ground counts only while the cart moves less than a
/// millimetre in between. Throws what the source or the rig are refused for.
MountEvidence gatherMountEvidence(const std::filesystem::path& source, const Rig& rig,
                                  const MountProgress& progress);

}  // namespace cartvo::calibrate
