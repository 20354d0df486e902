// Parsing of H.264 sequence parameter sets.

#include "capture/codec/sequence_parameter_set.hpp"

#include <algorithm>
#include <iterator>

#include "capture/codec/nal_units.hpp"

namespace cartvo::capture {
namespace {

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

std::optional<H264SequenceParameters> parseH264SequenceParameters(std::span<const std::uint8_t> nal) {
  H264SequenceParameters parameters;
  BitReader bits(nal.subspan(1));
  const std::uint32_t profile = bits.readBits(8);
  bits.readBits(16);             // constraint flags and level
  bits.readUnsignedExpGolomb();  // seq_parameter_set_id
  if (hasChromaFormat(profile)) {
    const std::uint32_t chroma_format = bits.readUnsignedExpGolomb();
    if (chroma_format == 3) parameters.separate_colour_planes = bits.readFlag();
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
  const std::uint32_t reference_pictures = bits.readUnsignedExpGolomb();
  parameters.frame_num_gaps_allowed = bits.readFlag();
  if (bits.isExhausted() || frame_num_bits_beyond_4 > 12 || reference_pictures > 16) return std::nullopt;
  parameters.frame_num_bits = static_cast<int>(frame_num_bits_beyond_4) + 4;
  parameters.reference_pictures = static_cast<int>(reference_pictures);
  return parameters;
}

}  // namespace cartvo::capture
