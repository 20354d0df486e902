#pragma once

#include <filesystem>
#include <string>

#include "calib/model/rig.hpp"
#include "capture/stereo_source.hpp"

namespace cartvo::pipeline {

/// A rig and its origin.
struct FoundRig {
  calib::Rig rig;
  std::string origin;  ///< a file, or "SOURCE/recording.json"
};

/// Finds the rig of a source: the file `given` if it is not empty, otherwise rig.yaml in the source's folder,
/// the rig in a recording, EuRoC's sensor.yaml, or KITTI's calib.txt. Throws std::runtime_error that lists
/// the expected files.
FoundRig findRig(const capture::StereoSource& source, const std::filesystem::path& path,
                 const std::filesystem::path& given);

}  // namespace cartvo::pipeline
