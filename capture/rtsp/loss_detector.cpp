// Loss detection from frame_num in H.264 slice headers, or from gaps in time.

#include "capture/rtsp/loss_detector.hpp"

#include <algorithm>
#include <vector>

#include "capture/codec/nal_units.hpp"

namespace cartvo::capture {
namespace {

bool isKey(const std::vector<NalUnit>& units) {
  return std::any_of(units.begin(), units.end(),
                     [](const NalUnit& u) { return u.kind == NalKind::key_slice; });
}

bool isSequenceParameterSet(std::span<const std::uint8_t> nal) {
  return (nal[0] & 0x1f) == 7;
}

/// Profiles whose parameter sets carry the chroma format and scaling lists (ITU-T H.264 7.3.2.1.1).
bool hasChromaFormat(std::uint32_t profile) {
  constexpr std::uint32_t kProfilesWithChromaFormat[] = {100, 110, 122, 244, 44,  83, 86,
                                                         118, 128, 138, 139, 134, 135};
  return std::find(std::begin(kProfilesWithChromaFormat), std::end(kProfilesWithChromaFormat), profile) !=
         std::end(kProfilesWithChromaFormat);
}

/// Skips scaling_list(), ITU-T H.264 7.3.2.1.1.1.
void skipScalingList(BitReader& bits, int size) {
  int last = 8;
  int next = 8;
  for (int i = 0; i < size && next != 0 && !bits.isExhausted(); ++i) {
    next = (last + bits.readSignedExpGolomb() % 256 + 256) % 256;
    if (next != 0) last = next;
  }
}

}  // namespace

LossDetector::LossDetector(const StreamFormat& format) : codec_(format.codec) {
  if (codec_ != VideoCodec::h264) return;
  for (const NalUnit& nal : splitNalUnits(codec_, format.parameter_sets)) {
    if (isSequenceParameterSet(nal.bytes)) parseSequenceParameterSet(nal.bytes);
  }
}

FrameStatus LossDetector::inspect(std::span<const std::uint8_t> unit, bool data_lost,
                                  std::uint64_t frames_missed) {
  const bool key = isKey(splitNalUnits(codec_, unit));
  const bool is_missing = codec_ == VideoCodec::h264 ? isReferenceMissing(unit) : frames_missed > 0;
  if (key) damaged_ = false;
  if (data_lost || (is_missing && !key)) damaged_ = true;
  return damaged_ ? FrameStatus::damaged : FrameStatus::good;
}

bool LossDetector::isReferenceMissing(std::span<const std::uint8_t> unit) {
  for (const NalUnit& nal : splitNalUnits(codec_, unit)) {
    if (nal.kind == NalKind::parameter_set && isSequenceParameterSet(nal.bytes))
      parseSequenceParameterSet(nal.bytes);
    if (nal.kind != NalKind::slice && nal.kind != NalKind::key_slice) continue;
    if (frame_num_bits_ == 0 || gaps_allowed_) return false;

    // slice_header(), ITU-T H.264 7.3.3
    BitReader bits(nal.bytes.subspan(1));
    bits.readUnsignedExpGolomb();  // first_mb_in_slice
    bits.readUnsignedExpGolomb();  // slice_type
    bits.readUnsignedExpGolomb();  // pic_parameter_set_id
    if (separate_colour_planes_) bits.readBits(2);
    const std::uint32_t frame_num = bits.readBits(frame_num_bits_);
    if (bits.isExhausted()) return true;

    const std::uint32_t modulus = 1U << frame_num_bits_;
    const bool is_consecutive = nal.kind == NalKind::key_slice || !last_reference_ ||
                                frame_num == *last_reference_ ||
                                frame_num == (*last_reference_ + 1) % modulus;
    if (nal.is_reference) last_reference_ = frame_num;
    return !is_consecutive;
  }
  return false;
}

/// Parses seq_parameter_set_data(), ITU-T H.264 7.3.2.1.1, up to gaps_in_frame_num_value_allowed_flag.
void LossDetector::parseSequenceParameterSet(std::span<const std::uint8_t> nal) {
  BitReader bits(nal.subspan(1));
  const std::uint32_t profile = bits.readBits(8);
  bits.readBits(16);             // constraint flags and level
  bits.readUnsignedExpGolomb();  // seq_parameter_set_id
  bool separate_colour_planes = false;
  if (hasChromaFormat(profile)) {
    const std::uint32_t chroma_format = bits.readUnsignedExpGolomb();
    if (chroma_format == 3) separate_colour_planes = bits.readFlag();
    bits.readUnsignedExpGolomb();  // bit_depth_luma_minus8
    bits.readUnsignedExpGolomb();  // bit_depth_chroma_minus8
    bits.readFlag();               // qpprime_y_zero_transform_bypass_flag
    if (bits.readFlag()) {
      const int lists = chroma_format == 3 ? 12 : 8;
      for (int i = 0; i < lists; ++i) {
        if (bits.readFlag()) skipScalingList(bits, i < 6 ? 16 : 64);
      }
    }
  }
  const std::uint32_t frame_num_bits_beyond_4 = bits.readUnsignedExpGolomb();
  const std::uint32_t order_type = bits.readUnsignedExpGolomb();
  if (order_type == 0) {
    bits.readUnsignedExpGolomb();  // log2_max_pic_order_cnt_lsb_minus4
  } else if (order_type == 1) {
    bits.readFlag();
    bits.readSignedExpGolomb();
    bits.readSignedExpGolomb();
    const std::uint32_t count = std::min(bits.readUnsignedExpGolomb(), 255U);
    for (std::uint32_t i = 0; i < count; ++i)
      bits.readSignedExpGolomb();
  }
  bits.readUnsignedExpGolomb();  // max_num_ref_frames
  const bool gaps_allowed = bits.readFlag();
  if (bits.isExhausted() || frame_num_bits_beyond_4 > 12) return;  // invalid parameter set
  frame_num_bits_ = static_cast<int>(frame_num_bits_beyond_4) + 4;
  separate_colour_planes_ = separate_colour_planes;
  gaps_allowed_ = gaps_allowed;
}

}  // namespace cartvo::capture
