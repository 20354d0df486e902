#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include "capture/recording_reader.hpp"

namespace cartvo {

/// What came of reading and decoding one camera's pictures as a replay does.
struct VerifiedCamera {
  std::uint64_t pictures = 0;  ///< decoded
  std::uint64_t damaged = 0;   ///< of these, not to be trusted: by loss on the way, or damage of the files
  RecordingDamage files;
  std::string unreadable;  ///< why nothing can be read; empty if something can
};

struct Verification {
  std::array<VerifiedCamera, 2> cameras;  ///< left, right

  /// The files are as they were recorded, of both cameras.
  bool whole() const;
};

/// Is told how many pictures have been looked at.
using VerificationProgress = std::function<void(std::size_t pictures)>;

/// Throws what readRecordingInfo throws.
Verification verifyRecording(const std::filesystem::path& folder, const VerificationProgress& progress);

nlohmann::ordered_json verificationJson(const Verification& verification);
std::string verificationText(const Verification& verification);

}  // namespace cartvo
