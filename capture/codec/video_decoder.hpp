#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include <opencv2/core/types.hpp>

#include "capture/encoded_unit.hpp"
#include "capture/frame.hpp"

namespace cartvo::capture {

/// Decodes H.264 or H.265 picture by picture without delay. The grey image is the luma plane in the decoder's
/// memory. Full-range and limited-range luma are not converted. The pictures of a stream with B-frames come
/// in the order of their exposures from the first key picture on after they were noticed, and later by the
/// number of B-frames.
class VideoDecoder {
 public:
  /// Default limit of a picture's size: larger than any camera's.
  static constexpr std::int64_t kMaxPixels = 64'000'000;

  /// `threads`: slice threads. Larger pictures than `max_pixels` are not decoded, and no memory is reserved
  /// for them. Throws std::runtime_error if FFmpeg lacks the decoder.
  VideoDecoder(const StreamFormat& format, int threads, std::int64_t max_pixels = kMaxPixels);
  ~VideoDecoder();
  VideoDecoder(const VideoDecoder&) = delete;
  VideoDecoder& operator=(const VideoDecoder&) = delete;

  /// Decodes one picture. `receive` returns the resulting frames.
  void send(const EncodedUnit& unit);

  /// Returns the next frame, with the instants, sequence and status of its unit. After decoder errors or
  /// missing references, frames are marked as damaged up to the next refresh (see RefreshDetector).
  std::optional<Frame> receive();

  /// Ends the stream; `receive` then returns the frames that the decoder still holds.
  void finish();

  /// Number of pictures that could not be decoded at all.
  std::uint64_t failures() const { return failures_; }

  /// Whether the stream or its description has had parameter sets, without which nothing can be decoded.
  bool hasParameterSets() const;

  /// Whether the stream has B-frames: its pictures are not sent in the order of their exposures.
  bool reorders() const;

  /// Size of the last key picture that was not decoded because it exceeds the limit; else empty.
  cv::Size refusedSize() const;

 private:
  struct Implementation;
  struct Pending;
  bool updateDamage(const Pending& pending, bool decoder_failed);

  std::unique_ptr<Implementation> implementation_;
  std::uint64_t failures_ = 0;
};

}  // namespace cartvo::capture
