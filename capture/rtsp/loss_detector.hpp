#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "capture/encoded_unit.hpp"

namespace cartvo::capture {

/// Detects that pictures are missing from a stream, and marks the pictures up to the next key frame as
/// damaged, because each picture is predicted from earlier ones. Reads no clock; deterministic.
///
/// H.264 numbers its reference pictures (frame_num, ITU-T H.264 7.4.3), so a missing one is always detected.
/// H.265 has no such number: there a gap in time counts as a loss.
class LossDetector {
 public:
  explicit LossDetector(const StreamFormat& format);

  /// Status of the next picture. `data_lost`: the receiver knows that data are missing before or in it;
  /// `frames_missed`: number of frame periods without a picture since the previous one.
  FrameStatus inspect(std::span<const std::uint8_t> unit, bool data_lost, std::uint64_t frames_missed);

 private:
  bool isReferenceMissing(std::span<const std::uint8_t> unit);
  void parseSequenceParameterSet(std::span<const std::uint8_t> nal);

  VideoCodec codec_;
  int frame_num_bits_ = 0;  ///< log2_max_frame_num; 0: unknown
  bool separate_colour_planes_ = false;
  bool gaps_allowed_ = false;
  std::optional<std::uint32_t> last_reference_;  ///< frame_num of the last reference picture
  bool damaged_ = false;
};

}  // namespace cartvo::capture
