#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>

namespace cartvo {

/// A part of a recording, s since its first picture's arrival.
struct TrimmedPart {
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
};

/// Copies a part into a new recording, as it was received, with its description: each camera from its last
/// key picture at or before `from` on. Returns the pictures copied, left and right. Throws std::runtime_error
/// if the recording cannot be read, the part holds no picture of a camera, or `output` cannot be written or
/// holds a recording.
std::array<std::uint64_t, 2> trimRecording(const std::filesystem::path& recording, const TrimmedPart& part,
                                           const std::filesystem::path& output);

}  // namespace cartvo
