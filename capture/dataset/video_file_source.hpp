#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "capture/camera_source.hpp"
#include "capture/dataset/picture_part.hpp"

// Video files of other recorders as frame sources.

namespace cartvo::capture {

/// Clock model of a video file: exposure = origin + offset + (1 + skew) * file time.
struct VideoFileTime {
  /// Frame rate, Hz, that replaces the file's time stamps. 0: the file's own.
  double frame_rate = 0.0;
  std::int64_t origin_ns = 0;
  double offset = 0.0;  ///< s
  double skew = 0.0;    ///< of the file's clock, relative
  double stddev = 0.0;  ///< of one camera's exposures, s: 1/sqrt(2) of that of right minus left

  // The part to read, file time, s.
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
};

/// Where a camera's pictures are in a video file.
struct VideoView {
  PicturePart part = PicturePart::whole;
  std::optional<int> track;  ///< number of the video track, from 0; empty: the one that FFmpeg prefers
};

/// Frame source for a video file of another recorder, in any container and codec that FFmpeg reads: luma of
/// one video track. Pictures with decoding errors are marked as damaged up to the next key picture.
/// Opens no other file or address. Never waits.
class VideoFileSource : public CameraSource {
 public:
  /// Throws std::runtime_error naming the file if it cannot be opened, contains no video that can be decoded,
  /// or has no usable time stamps and no frame rate: FFmpeg takes 25 Hz for streams that declare none.
  VideoFileSource(const std::filesystem::path& file, const VideoFileTime& time, const VideoView& view = {});
  ~VideoFileSource() override;
  VideoFileSource(const VideoFileSource&) = delete;
  VideoFileSource& operator=(const VideoFileSource&) = delete;

  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

  /// Time stamp of the last frame read, s, in the file's time.
  double fileTime() const;

  /// Size of the whole pictures by the file's header, px.
  cv::Size pictureSize() const;

  /// Number of the file's video tracks.
  int tracks() const;

  /// Note on the origin of the file times if they are not time stamps; else empty.
  std::string timeNote() const;

  /// Number of pictures by the file's header, or from its duration and frame rate; 0: unknown.
  std::size_t expectedPictures() const;

  /// Creation time in the file's metadata, ns since the Unix epoch; 0: unknown.
  std::int64_t creationNs() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo::capture
