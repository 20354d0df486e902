#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "capture/camera_side.hpp"
#include "capture/encoded_unit.hpp"

// Reading of the encoded pictures of a recording.

namespace cartvo::capture {

/// One picture of a recording with its index entry.
struct RecordedUnit {
  EncodedUnit unit;  ///< as received; marked damaged also where the file is
  StreamFormat format;
  cv::Size picture_size;  ///< from the file's header, px
  std::uint64_t segment = 0;
  std::uint64_t connection = 0;  ///< counts the camera's connections from 1
};

/// Damage to one camera's part of a recording.
struct RecordingDamage {
  std::uint64_t lost = 0;           ///< pictures in the index that cannot be read
  std::uint64_t altered = 0;        ///< pictures whose checksum differs, or that are not in the index
  std::vector<std::string> places;  ///< a sentence each, at most kMaxDamagePlaces
};
inline constexpr std::size_t kMaxDamagePlaces = 20;

/// Reads one camera's pictures from a recording, segment by segment. Where files are truncated or
/// overwritten, it continues after the damage; pictures from there to the next key picture are marked as
/// damaged.
class RecordingReader {
 public:
  /// Throws std::runtime_error naming the first problem if no segment can be read.
  RecordingReader(const std::filesystem::path& folder, CameraSide side);
  ~RecordingReader();
  RecordingReader(const RecordingReader&) = delete;
  RecordingReader& operator=(const RecordingReader&) = delete;

  /// Reads the next picture. False at the end.
  bool next(RecordedUnit& recorded);

  /// Damage found so far.
  const RecordingDamage& damage() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::capture
