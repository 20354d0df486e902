#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>

#include "capture/encoded_unit.hpp"
#include "capture/frame.hpp"

namespace cartvo {

/// Decodes H.264 or H.265 picture by picture without delay, and hands out the luma plane as the grey image,
/// in the decoder's own memory. Full-range and limited-range luma are both taken as they are.
class VideoDecoder {
 public:
  /// `threads`: slice threads. Throws std::runtime_error if FFmpeg lacks the decoder.
  VideoDecoder(const StreamFormat& format, int threads);
  ~VideoDecoder();
  VideoDecoder(const VideoDecoder&) = delete;
  VideoDecoder& operator=(const VideoDecoder&) = delete;

  /// Decodes one picture. Frames that come of it are fetched with `receive`.
  void send(const EncodedUnit& unit);

  /// The next frame, with the instants, sequence and status of its unit. Marked damaged, until the next key
  /// frame, also where the decoder met errors or missing references.
  std::optional<Frame> receive();

  /// No more units: frames that the decoder holds back may be received.
  void finish();

  /// Pictures that could not be decoded at all.
  std::uint64_t failures() const { return failures_; }

 private:
  struct Implementation;
  struct Pending;
  bool damagedSince(const Pending& pending, bool decoder_failed);

  std::unique_ptr<Implementation> implementation_;
  std::uint64_t failures_ = 0;
};

}  // namespace cartvo
