#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "capture/camera_side.hpp"
#include "capture/encoded_unit.hpp"

namespace cartvo {

/// One picture of a recording with what the index says of it.
struct RecordedUnit {
  EncodedUnit unit;  ///< as it was received; damaged also where the file is
  StreamFormat format;
  cv::Size picture_size;  ///< by the file's header, px
  std::uint64_t segment = 0;
  std::uint64_t connection = 0;  ///< counts the camera's connections from 1
};

/// What is wrong with one camera's part of a recording.
struct RecordingDamage {
  std::uint64_t lost = 0;     ///< pictures that the index tells of and that cannot be read
  std::uint64_t altered = 0;  ///< pictures that are not as they were recorded, or without a line in the index
  std::vector<std::string> places;  ///< a sentence each, at most kMostDamagePlaces of them
};
inline constexpr std::size_t kMostDamagePlaces = 20;

/// Reads one camera's pictures from a recording, segment by segment. Where files are cut short or overwritten
/// it goes on with what can be read behind; pictures between the damage and the next key picture are marked
/// as damaged.
class RecordingReader {
 public:
  /// Throws std::runtime_error if no segment can be read, saying why.
  RecordingReader(const std::filesystem::path& folder, CameraSide side);
  ~RecordingReader();
  RecordingReader(const RecordingReader&) = delete;
  RecordingReader& operator=(const RecordingReader&) = delete;

  /// False at the end.
  bool next(RecordedUnit& recorded);

  /// Of what was read so far.
  const RecordingDamage& damage() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
