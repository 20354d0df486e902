#pragma once

#include <filesystem>
#include <vector>

#include "capture/camera_source.hpp"
#include "tools/calibrate/readout/mains_bands.hpp"

namespace cartvo::calibrate {

constexpr std::size_t kMaxProfiles = 400;

/// Profiles of both cameras; empty for a camera that was not read.
struct StereoProfiles {
  std::vector<RowProfile> left, right;
};

/// Profiles of the first good pictures of a camera, at most kMaxProfiles, until it ends or `seconds` have
/// passed by the host's clock. Throws std::runtime_error if the size of its pictures changes.
std::vector<RowProfile> readProfiles(capture::CameraSource& camera, double seconds);

/// Profiles from what openCameraFiles opens, with its arguments. Throws what it throws.
StereoProfiles profilesOfFiles(const std::filesystem::path& source, const std::filesystem::path& right,
                               double frame_rate);

/// Profiles from the cameras of a configuration file, during `seconds`. Throws what LiveCamera throws.
StereoProfiles profilesOfLiveCameras(const std::filesystem::path& configuration, double seconds);

}  // namespace cartvo::calibrate
