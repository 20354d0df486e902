#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include "capture/camera_source.hpp"
#include "tools/calibrate/readout/mains_bands.hpp"

namespace cartvo::calibrate {

constexpr std::size_t kMaxProfiles = 400;

/// Profiles of both cameras; empty for a camera that was not read.
struct StereoProfiles {
  std::vector<RowProfile> left, right;
};

/// Called during the work: how much of it is done, in pictures of both cameras, or in seconds of live
/// cameras. `total`: 0 if unknown.
using ProfileProgress = std::function<void(std::size_t done, std::size_t total)>;

/// Profiles of the first good pictures of a camera, at most kMaxProfiles, until it ends or `seconds` have
/// passed by the host's clock. Calls `picture_read` after each. Throws std::runtime_error if the size of its
/// pictures changes.
std::vector<RowProfile> readProfiles(capture::CameraSource& camera, double seconds,
                                     const std::function<void()>& picture_read);

/// Profiles from what openCameraFiles opens, with its arguments. Throws what it throws.
StereoProfiles profilesOfFiles(const std::filesystem::path& source, const std::filesystem::path& right,
                               double frame_rate, const ProfileProgress& progress);

/// Profiles from the cameras of a configuration file, during `seconds`. Throws what LiveCamera throws.
StereoProfiles profilesOfLiveCameras(const std::filesystem::path& configuration, double seconds,
                                     const ProfileProgress& progress);

}  // namespace cartvo::calibrate
