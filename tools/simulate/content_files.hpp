#pragma once

#include <cstdint>
#include <filesystem>

#include "tools/simulate/content.hpp"
#include "tools/simulate/encode_content.hpp"

namespace cartvo::simulate {

/// Writes what describes the content beside a simulation or its images, atomically each: rig.yaml, poses.txt
/// (KITTI, left camera relative to the first one; only where the truth is known), times_0.txt and times_1.txt
/// (seconds since the content's start, nine decimals). Makes the folder.
void writeDescription(const std::filesystem::path& folder, const Content& content);

/// truth.tum: T_world_body at the left instants, `epoch_ns` added to them. Nothing if the truth is unknown.
void writeTruth(const std::filesystem::path& folder, const Content& content, std::int64_t epoch_ns);

/// Writes an image folder in KITTI's layout: image_0 and image_1 (PNG), the description, truth.tum, and
/// calib.txt if the rig is rectified. It appears whole or not at all. Throws std::runtime_error if the folder
/// exists and is not empty.
void renderFolder(const std::filesystem::path& folder, const Content& content, const Progress& progress);

}  // namespace cartvo::simulate
