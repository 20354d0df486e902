#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "capture/dataset/image_folder.hpp"

// Instants of listed images; internal to capture.

namespace cartvo::capture {

/// Sets the instants of the listed images of both cameras, by the first of these that there is:
/// - a frame rate (Hz) above 0, and the numbers in the names
/// - times_0.txt and times_1.txt, or times.txt, in one of the folders `places`
/// - instants in the names, see instantsInNames
///
/// Where both cameras share their instants, orders the right images as their left partners by name. Throws
/// std::runtime_error naming what was looked for, or the file and line and what is wrong.
void readInstants(ImageFolder& folder, const std::vector<std::filesystem::path>& places, double frame_rate);

/// The instants in the names of images, ns: seconds since 1970 with decimals (1225719884.662058), or 13, 16
/// or 19 digits, which are milli-, micro- or nanoseconds since 1970. Empty unless each name has one.
std::vector<std::int64_t> instantsInNames(const std::vector<std::filesystem::path>& images);

}  // namespace cartvo::capture
