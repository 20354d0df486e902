// Loss detection from lost packets and from frame_num in H.264 slice headers.

#include "capture/rtsp/loss_detector.hpp"

#include <algorithm>

namespace cartvo::capture {
namespace {

bool isSequenceParameterSet(const NalUnit& unit) {
  return unit.kind == NalKind::parameter_set && (unit.bytes[0] & 0x1f) == 7;
}

}  // namespace

LossDetector::LossDetector(const StreamFormat& format) : codec_(format.codec), refreshes_(format) {
  if (codec_ == VideoCodec::h264) isReferenceMissing(splitNalUnits(codec_, format.parameter_sets));
}

PictureInspection LossDetector::inspect(std::span<const std::uint8_t> unit, bool data_lost) {
  const std::vector<NalUnit> units = splitNalUnits(codec_, unit);
  const PictureRefresh refresh = refreshes_.inspect(units);
  const bool is_missing = codec_ == VideoCodec::h264 && isReferenceMissing(units);
  if (refresh.is_complete) damaged_ = false;
  if (data_lost) refreshes_.restart();
  // A picture where decoding can begin needs none that is missing.
  if (is_missing && !refresh.is_access_point) refreshes_.restart();
  if (data_lost || (is_missing && !(refresh.is_access_point && refresh.is_complete))) damaged_ = true;
  return {damaged_ ? FrameStatus::damaged : FrameStatus::good, refresh.is_access_point};
}

/// Whether a reference picture before this H.264 picture is missing.
bool LossDetector::isReferenceMissing(const std::vector<NalUnit>& units) {
  for (const NalUnit& unit : units) {
    if (isSequenceParameterSet(unit)) {
      if (const auto parameters = parseH264SequenceParameters(unit.bytes)) parameters_ = parameters;
    }
    // The first slice tells for all of them.
    if (unit.kind == NalKind::slice || unit.kind == NalKind::key_slice) return isReferenceMissing(unit);
  }
  return false;
}

/// Reads frame_num in slice_header(), ITU-T H.264 7.3.3.
bool LossDetector::isReferenceMissing(const NalUnit& slice) {
  if (!parameters_ || parameters_->frame_num_gaps_allowed) return false;
  BitReader bits(slice.bytes.subspan(1));
  bits.readUnsignedExpGolomb();  // first_mb_in_slice
  bits.readUnsignedExpGolomb();  // slice_type
  bits.readUnsignedExpGolomb();  // pic_parameter_set_id
  if (parameters_->separate_colour_planes) bits.readBits(2);
  const std::uint32_t frame_num = bits.readBits(parameters_->frame_num_bits);
  if (bits.isExhausted()) return true;

  const std::uint32_t modulus = 1U << parameters_->frame_num_bits;
  const bool is_consecutive = slice.kind == NalKind::key_slice || !last_reference_ ||
                              frame_num == *last_reference_ || frame_num == (*last_reference_ + 1) % modulus;
  if (slice.is_reference) last_reference_ = frame_num;
  return !is_consecutive;
}

}  // namespace cartvo::capture
