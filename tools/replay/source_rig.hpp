#pragma once

#include <filesystem>
#include <string>

#include "calib/rig.hpp"
#include "capture/stereo_source.hpp"

namespace cartvo {

/// A rig and where it was found.
struct FoundRig {
  Rig rig;
  std::string origin;  ///< a file, or "SOURCE/recording.json"
};

/// The rig of a source: `given` if it is not empty, else what lies beside the images: rig.yaml, a recording's
/// own rig, EuRoC's sensor.yaml, KITTI's calib.txt. Throws std::runtime_error that lists what was looked for.
FoundRig findRig(const StereoSource& source, const std::filesystem::path& path,
                 const std::filesystem::path& given);

}  // namespace cartvo
