// NAL units of H.264 and H.265 streams, a bit reader for H.264 headers, and sequence parameter sets.
#include "capture/codec/nal_units.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>

namespace cartvo::capture {
namespace {

constexpr std::array<std::uint8_t, 3> kStartCode = {0, 0, 1};

NalUnit classifyH264(std::span<const std::uint8_t> nal) {
  NalUnit unit{nal};
  const int type = nal[0] & 0x1f;
  unit.is_reference = (nal[0] & 0x60) != 0;
  if (type == 1 || type == 5) {
    unit.kind = type == 5 ? NalKind::key_slice : NalKind::slice;
  } else if (type == 7 || type == 8) {
    unit.kind = NalKind::parameter_set;
  }
  return unit;
}

NalUnit classifyH265(std::span<const std::uint8_t> nal) {
  NalUnit unit{nal};
  const int type = (nal[0] >> 1) & 0x3f;
  if (type < 32) {
    unit.kind = type >= 16 && type <= 21 ? NalKind::key_slice : NalKind::slice;  // IRAP: 16 to 21
    unit.is_reference = true;
  } else if (type <= 34) {
    unit.kind = NalKind::parameter_set;
  }
  return unit;
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

std::span<const std::uint8_t>::iterator findStartCode(std::span<const std::uint8_t> data) {
  auto from = data.begin();
  while (data.end() - from >= 3) {
    // The code's last byte is the rarest one to search for.
    const void* found = std::memchr(&from[2], 1, static_cast<std::size_t>(data.end() - from - 2));
    if (found == nullptr) break;
    from += static_cast<const std::uint8_t*>(found) - &from[2];
    if (from[0] == 0 && from[1] == 0) return from;
    ++from;
  }
  return data.end();
}

std::size_t nalHeaderSize(VideoCodec codec) {
  return codec == VideoCodec::h264 ? 1 : 2;
}

NalPlace nalPlace(VideoCodec codec, std::span<const std::uint8_t> nal) {
  const std::size_t header = nalHeaderSize(codec);
  if (nal.size() < header) return NalPlace::other;
  // first_mb_in_slice is 0 (one bit 1), or first_slice_segment_in_pic_flag is set.
  const bool is_first = nal.size() > header && (nal[header] & 0x80) != 0;
  if (codec == VideoCodec::h264) {
    const int type = nal[0] & 0x1f;
    if (type == 1 || type == 2 || type == 5) return is_first ? NalPlace::first_slice : NalPlace::slice;
    if (type == 3 || type == 4) return NalPlace::slice;
    return (type >= 6 && type <= 9) || (type >= 15 && type <= 18) ? NalPlace::before_slices : NalPlace::other;
  }
  const int type = (nal[0] >> 1) & 0x3f;
  if (type < 32) return is_first ? NalPlace::first_slice : NalPlace::slice;
  const bool before = type <= 35 || type == 39 || (type >= 41 && type <= 44) || (type >= 48 && type <= 55);
  return before ? NalPlace::before_slices : NalPlace::other;
}

bool isKeySlice(VideoCodec codec, std::span<const std::uint8_t> nal) {
  const NalUnit unit = codec == VideoCodec::h264 ? classifyH264(nal) : classifyH265(nal);
  return unit.kind == NalKind::key_slice;
}

std::vector<NalUnit> splitNalUnits(VideoCodec codec, std::span<const std::uint8_t> data) {
  std::vector<NalUnit> units;
  const auto next = [&](auto from) { return findStartCode({from, data.end()}); };
  for (auto code = next(data.begin()); code != data.end();) {
    const auto begin = code + kStartCode.size();
    code = next(begin);
    auto end = code;
    while (end != begin && *(end - 1) == 0)
      --end;  // first byte of a four-byte start code, and trailing zeros
    const std::span<const std::uint8_t> nal(begin, end);
    if (nal.size() < nalHeaderSize(codec)) continue;
    units.push_back(codec == VideoCodec::h264 ? classifyH264(nal) : classifyH265(nal));
  }
  return units;
}

std::vector<std::uint8_t> parameterSets(VideoCodec codec, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> sets;
  for (const NalUnit& unit : splitNalUnits(codec, data)) {
    if (unit.kind != NalKind::parameter_set) continue;
    sets.push_back(0);
    sets.insert(sets.end(), kStartCode.begin(), kStartCode.end());
    sets.insert(sets.end(), unit.bytes.begin(), unit.bytes.end());
  }
  return sets;
}

std::uint32_t BitReader::readBit() {
  if (bits_left_ == 0) {
    if (zeros_ >= 2 && position_ < bytes_.size() && bytes_[position_] == 3) {
      ++position_;
      zeros_ = 0;
    }
    if (position_ >= bytes_.size()) {
      exhausted_ = true;
      return 0;
    }
    current_ = bytes_[position_++];
    zeros_ = current_ == 0 ? zeros_ + 1 : 0;
    bits_left_ = 8;
  }
  --bits_left_;
  return (current_ >> bits_left_) & 1U;
}

std::uint32_t BitReader::readBits(int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i)
    value = (value << 1) | readBit();
  return value;
}

std::uint32_t BitReader::readUnsignedExpGolomb() {
  int zeros = 0;
  while (zeros < 32 && !exhausted_ && readBit() == 0)
    ++zeros;
  if (zeros >= 32 || exhausted_) return 0;
  return (1U << zeros) - 1U + readBits(zeros);
}

std::int32_t BitReader::readSignedExpGolomb() {
  const std::uint32_t code = readUnsignedExpGolomb();
  const auto magnitude = static_cast<std::int32_t>((code + 1) / 2);
  return code % 2 == 1 ? magnitude : -magnitude;
}

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
