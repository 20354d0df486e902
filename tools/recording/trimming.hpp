#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>

namespace cartvo {

/// A time interval of a recording, s since the arrival of its first picture.
struct TrimmedPart {
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
};

/// The copied part of a recording.
struct TrimmedRecording {
  std::array<std::uint64_t, 2> pictures{};  ///< left, right
  double from = 0.0, to = 0.0;              ///< of the copied pictures, as in TrimmedPart
};

/// Called before each picture is copied, with the number of both cameras' pictures so far and in the part.
using TrimProgress = std::function<void(std::size_t pictures, std::size_t expected)>;

/// Copies a part of a recording, as received and with its description, to a new recording. Each camera starts
/// at its last key picture at or before `from`. Removes what it wrote if it fails or `progress` throws.
/// Throws std::runtime_error if the recording cannot be read, the part contains no picture of a camera, or
/// `output` cannot be written or already contains a recording.
TrimmedRecording trimRecording(const std::filesystem::path& recording, const TrimmedPart& part,
                               const std::filesystem::path& output, const TrimProgress& progress);

}  // namespace cartvo
