#pragma once

#include <cstdint>
#include <filesystem>

#include "tools/simulate/content.hpp"
#include "tools/simulate/stream/encode_content.hpp"

namespace cartvo::simulate {

/// Writes the description of a content, each file atomically: rig.yaml, poses.txt (KITTI: left camera
/// relative to the first pose; only if the truth is known), times_0.txt and times_1.txt (s since the
/// content's start, nine decimals). Creates the folder.
void writeDescription(const std::filesystem::path& folder, const Content& content);

/// Writes truth.tum: T_world_body at the instants of Content::denseTruth() plus `epoch_ns`. No file if the
/// truth is unknown.
void writeTruth(const std::filesystem::path& folder, const Content& content, std::int64_t epoch_ns);

/// Writes an image folder in the KITTI layout: image_0 and image_1 (PNG), the description, truth.tum, and
/// calib.txt if the rig is rectified. The folder is complete or absent. Throws std::runtime_error if it
/// exists and is not empty.
void renderFolder(const std::filesystem::path& folder, const Content& content, const Progress& progress);

}  // namespace cartvo::simulate
