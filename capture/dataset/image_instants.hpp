#pragma once

#include <cstdint>
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

/// Unit of the instants in a file.
enum class TimeUnit : std::uint8_t { seconds, nanoseconds };

/// Whether an interval (s) between two frames is that of a camera: 1 ms to 2 s.
bool isPlausibleInterval(double interval);

/// Throws std::runtime_error unless the median interval of the instants (ns, as read from `file` in `unit`)
/// is that of a camera, 1 ms to 2 s. The message states the interval and the unit in which the instants would
/// be plausible. Less than two instants pass.
void requirePlausibleInterval(const std::vector<std::int64_t>& instants_ns, const std::filesystem::path& file,
                              TimeUnit unit);

/// Warning if the instants are 0, 1, 2 ... s, which may be frame numbers; else empty.
std::string frameNumberWarning(const std::vector<std::int64_t>& instants_ns,
                               const std::filesystem::path& file);

}  // namespace cartvo::capture
