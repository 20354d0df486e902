// Access points and recovery points of a stream.

#include "capture/codec/refresh_detector.hpp"

#include <algorithm>

#include "capture/codec/nal_units.hpp"

namespace cartvo::capture {
namespace {

constexpr std::uint32_t kRecoveryPointPayload = 6;  // ITU-T H.264 table D-1 and H.265 D.2.1
constexpr int kMaxRecovery = 1000;                  // pictures; an encoder refreshes within seconds

bool isSupplementalInformation(VideoCodec codec, const NalUnit& unit) {
  if (codec == VideoCodec::h264) return (unit.bytes[0] & 0x1f) == 6;
  return ((unit.bytes[0] >> 1) & 0x3f) == 39;
}

/// Reads sei_message()'s payload type or size: bytes of 255, and a last one (ITU-T H.264 7.3.2.3.1).
std::uint32_t readSeiNumber(BitReader& bits) {
  std::uint32_t value = 0;
  for (std::uint32_t byte = 0xff; byte == 0xff && !bits.isExhausted();) {
    byte = bits.readBits(8);
    value += byte;
  }
  return value;
}

/// Number of pictures after which a recovery point is complete; nothing if the NAL unit has none.
std::optional<int> recoveryPoint(VideoCodec codec, const NalUnit& unit) {
  BitReader bits(unit.bytes.subspan(nalHeaderSize(codec)));
  while (!bits.isExhausted()) {
    const std::uint32_t type = readSeiNumber(bits);
    const std::uint32_t size = readSeiNumber(bits);
    if (bits.isExhausted()) break;
    if (type == kRecoveryPointPayload) {
      const int count = codec == VideoCodec::h264 ? static_cast<int>(bits.readUnsignedExpGolomb())
                                                  : bits.readSignedExpGolomb();
      if (bits.isExhausted()) break;
      return std::clamp(count, 0, kMaxRecovery);
    }
    for (std::uint32_t i = 0; i < size && !bits.isExhausted(); ++i)
      bits.readBits(8);
  }
  return std::nullopt;
}

/// Whether an H.264 slice is of type I or SI (ITU-T H.264 table 7-6).
bool isIntraSlice(const NalUnit& unit) {
  BitReader bits(unit.bytes.subspan(1));
  bits.readUnsignedExpGolomb();  // first_mb_in_slice
  const std::uint32_t type = bits.readUnsignedExpGolomb() % 5;
  return !bits.isExhausted() && (type == 2 || type == 4);
}

}  // namespace

RefreshDetector::RefreshDetector(const StreamFormat& format) : codec_(format.codec) {
  picturesToRecovery(splitNalUnits(codec_, format.parameter_sets));
}

/// Number of pictures after this one until decoding that begins with it is right; nothing if it cannot begin
/// here.
std::optional<int> RefreshDetector::picturesToRecovery(const std::vector<NalUnit>& units) {
  bool has_key = false;
  bool has_slices = false;
  bool all_intra = codec_ == VideoCodec::h264;
  std::optional<int> recovery;
  for (const NalUnit& unit : units) {
    if (unit.kind == NalKind::key_slice) has_key = true;
    if (unit.kind == NalKind::slice) {
      has_slices = true;
      all_intra = all_intra && isIntraSlice(unit);
    }
    if (unit.kind == NalKind::parameter_set && codec_ == VideoCodec::h264 && (unit.bytes[0] & 0x1f) == 7) {
      if (const auto parameters = parseH264SequenceParameters(unit.bytes))
        reference_pictures_ = parameters->reference_pictures;
    }
    if (!recovery && isSupplementalInformation(codec_, unit)) recovery = recoveryPoint(codec_, unit);
  }
  if (has_key) return 0;
  if (has_slices && recovery) return recovery;
  // Later pictures may refer to those before an I picture until they have left the decoder's memory.
  if (has_slices && all_intra) return std::max(reference_pictures_ - 1, 0);
  return std::nullopt;
}

PictureRefresh RefreshDetector::inspect(const std::vector<NalUnit>& units) {
  const std::optional<int> recovery = picturesToRecovery(units);
  if (remaining_ && *remaining_ > 0) --*remaining_;
  if (recovery) remaining_ = std::min(remaining_.value_or(*recovery), *recovery);
  return {recovery.has_value(), remaining_ == 0};
}

}  // namespace cartvo::capture
