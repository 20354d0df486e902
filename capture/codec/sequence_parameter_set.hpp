#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace cartvo::capture {

/// The used values of an H.264 sequence parameter set (ITU-T H.264 7.3.2.1.1).
struct H264SequenceParameters {
  int frame_num_bits = 0;  ///< log2_max_frame_num
  bool separate_colour_planes = false;
  bool frame_num_gaps_allowed = false;
  int reference_pictures = 0;  ///< max_num_ref_frames
};

/// Parses an H.264 NAL unit of type 7; nothing if it is invalid.
std::optional<H264SequenceParameters> parseH264SequenceParameters(std::span<const std::uint8_t> nal);

}  // namespace cartvo::capture
