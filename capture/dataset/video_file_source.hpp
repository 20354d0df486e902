#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>

#include "capture/camera_source.hpp"

// Video files of other recorders as frame sources.

namespace cartvo::capture {

/// Clock model of a video file: exposure = origin + offset + (1 + skew) * file time.
struct VideoFileTime {
  std::int64_t origin_ns = 0;
  double offset = 0.0;  ///< s
  double skew = 0.0;    ///< of the file's clock, relative
  double stddev = 0.0;  ///< of one camera's exposures, s: 1/sqrt(2) of that of right minus left

  // The part to read, file time, s.
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
};

/// Frame source for a video file of another recorder, in any container and codec that FFmpeg reads: luma of
/// its first video stream. Pictures with decoding errors are marked as damaged up to the next key picture.
/// Opens no other file or address. Never waits.
class VideoFileSource : public CameraSource {
 public:
  /// Throws std::runtime_error naming the file if it cannot be opened or contains no video that can be
  /// decoded.
  VideoFileSource(const std::filesystem::path& file, const VideoFileTime& time);
  ~VideoFileSource() override;
  VideoFileSource(const VideoFileSource&) = delete;
  VideoFileSource& operator=(const VideoFileSource&) = delete;

  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

  /// Time stamp of the last frame read, s, in the file's time.
  double fileTime() const;

  /// Number of pictures by the file's header, or from its duration and frame rate; 0: unknown.
  std::size_t expectedPictures() const;

  /// Creation time in the file's metadata, ns since the Unix epoch; 0: unknown.
  std::int64_t creationNs() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::capture
