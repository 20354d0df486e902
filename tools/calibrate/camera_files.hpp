#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "capture/camera_source.hpp"

namespace cartvo::calibrate {

/// Cameras on disk, each to be read for itself.
struct CameraFiles {
  std::unique_ptr<capture::CameraSource> left;
  std::unique_ptr<capture::CameraSource> right;  ///< null if `left` is a single video
  std::size_t pictures = 0;                      ///< of each camera, about; 0: unknown
};

/// Opens a recording, an image folder, or videos: `right` is the right camera's video, and empty if `source`
/// is not the left camera's of two. A single video counts as the left camera's. `frame_rate`: Hz, replaces
/// the time stamps; 0: none. Throws what openSource and VideoFileSource throw.
CameraFiles openCameraFiles(const std::filesystem::path& source, const std::filesystem::path& right,
                            double frame_rate);

}  // namespace cartvo::calibrate
