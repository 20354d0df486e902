#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cartvo::capture {

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
