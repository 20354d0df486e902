#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>

#include "capture/camera_source.hpp"

namespace cartvo {

/// How a file's own time becomes instants of exposure: exposure = origin + offset + (1 + skew) * time.
struct VideoFileTime {
  std::int64_t origin_ns = 0;
  double offset = 0.0;  ///< s
  double skew = 0.0;    ///< of the file's clock
  double deviation =
      0.0;  ///< standard deviation of the exposures against the other camera's, half the variance, s

  // The part that is read, by the file's own time, s.
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
};

/// A video that others recorded, in any container and codec that FFmpeg reads, as one camera: its first video
/// stream, its luma. Pictures that could not be decoded rightly are marked as damaged up to the next key
/// picture. Opens nothing but that file. Never waits.
class VideoFileSource : public CameraSource {
 public:
  /// Throws std::runtime_error if the file cannot be opened or holds no video that can be decoded.
  VideoFileSource(const std::filesystem::path& file, const VideoFileTime& time);
  ~VideoFileSource() override;
  VideoFileSource(const VideoFileSource&) = delete;
  VideoFileSource& operator=(const VideoFileSource&) = delete;

  ReadOutcome read(Frame& frame, std::chrono::milliseconds timeout) override;
  CameraHealth health() const override;
  void interrupt() noexcept override;

  /// Of the last frame read, by the file's own time stamps, s.
  double fileTime() const;

  /// Pictures that the file says it holds, or that its length makes likely; 0: unknown.
  std::size_t expectedPictures() const;

  /// When the recording began, ns since the Unix epoch, if the file says so, else 0.
  std::int64_t creationNs() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace cartvo
