#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "capture/encoded_unit.hpp"
#include "capture/frame.hpp"

namespace cartvo::capture {

/// Decodes H.264 or H.265 picture by picture without delay. The grey image is the luma plane in the decoder's
/// memory. Full-range and limited-range luma are not converted.
class VideoDecoder {
 public:
  /// `threads`: slice threads. Throws std::runtime_error if FFmpeg lacks the decoder.
  VideoDecoder(const StreamFormat& format, int threads);
  ~VideoDecoder();
  VideoDecoder(const VideoDecoder&) = delete;
  VideoDecoder& operator=(const VideoDecoder&) = delete;

  /// Decodes one picture. `receive` returns the resulting frames.
  void send(const EncodedUnit& unit);

  /// Returns the next frame, with the instants, sequence and status of its unit. After decoder errors or
  /// missing references, frames are marked as damaged up to the next key frame.
  std::optional<Frame> receive();

  /// Ends the stream; `receive` then returns the frames that the decoder still holds.
  void finish();

  /// Number of pictures that could not be decoded at all.
  std::uint64_t failures() const { return failures_; }

 private:
  struct Implementation;
  struct Pending;
  bool updateDamage(const Pending& pending, bool decoder_failed);

  std::unique_ptr<Implementation> implementation_;
  std::uint64_t failures_ = 0;
};

}  // namespace cartvo::capture
