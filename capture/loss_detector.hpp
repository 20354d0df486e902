#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "capture/encoded_unit.hpp"

namespace cartvo {

/// Notices that pictures are missing from a stream, and remembers it until the next key frame, because each
/// picture is predicted from those before it. Pure.
///
/// H.264 numbers its reference pictures (frame_num, ITU-T H.264 7.4.3), so a missing one shows however it was
/// lost. H.265 has no such number: there a gap in time counts as a loss.
class LossDetector {
 public:
  explicit LossDetector(const StreamFormat& format);

  /// The next picture's status. `data_lost`: the receiver knows that something is missing before or in it;
  /// `frames_missed`: how many frame periods without a picture lie between it and the one before.
  FrameStatus inspect(std::span<const std::uint8_t> unit, bool data_lost, std::uint64_t frames_missed);

 private:
  bool referenceMissing(std::span<const std::uint8_t> unit);
  void readSequenceParameters(std::span<const std::uint8_t> nal);

  VideoCodec codec_;
  int frame_num_bits_ = 0;  ///< log2_max_frame_num; 0: not known yet
  bool separate_colour_planes_ = false;
  bool gaps_allowed_ = false;
  std::optional<std::uint32_t> last_reference_;  ///< frame_num of the last reference picture
  bool damaged_ = false;
};

}  // namespace cartvo
