#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "capture/recording/recording_reader.hpp"

namespace cartvo {

/// Result of reading and decoding the pictures of one camera as a replay does.
struct VerifiedCamera {
  std::uint64_t pictures = 0;  ///< number decoded
  std::uint64_t damaged = 0;   ///< decoded with errors, by packet loss or damaged files
  capture::RecordingDamage files;
  std::string unreadable;  ///< error if no picture can be read, else empty
};

/// Result of verifyRecording().
struct Verification {
  bool is_empty = false;                  ///< no picture of either camera was recorded
  std::array<VerifiedCamera, 2> cameras;  ///< left, right

  /// Whether the files of both cameras are as they were recorded.
  bool isWhole() const;
};

/// Called after each picture with the number of pictures decoded so far.
using VerificationProgress = std::function<void(std::size_t pictures)>;

/// Verifies a recording; damage is part of the result. Throws what readRecordingInfo throws.
Verification verifyRecording(const std::filesystem::path& folder, const VerificationProgress& progress);

/// The result as JSON and as text.
nlohmann::ordered_json verificationJson(const Verification& verification);
std::string verificationText(const Verification& verification);

}  // namespace cartvo
