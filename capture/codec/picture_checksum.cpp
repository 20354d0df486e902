// CRC-32 of encoded pictures and of text.

#include "capture/codec/picture_checksum.hpp"

extern "C" {
#include <libavutil/crc.h>
}

#include "capture/codec/nal_units.hpp"

namespace cartvo::capture {
namespace {

constexpr std::uint32_t kInitial = 0xffffffffU;

std::uint32_t add(std::uint32_t crc, const std::uint8_t* data, std::size_t size) {
  return av_crc(av_crc_get_table(AV_CRC_32_IEEE_LE), crc, data, size);
}

}  // namespace

std::uint32_t pictureChecksum(VideoCodec codec, std::span<const std::uint8_t> unit) {
  std::uint32_t crc = kInitial;
  for (const NalUnit& nal : splitNalUnits(codec, unit)) {
    if (nal.kind != NalKind::parameter_set) crc = add(crc, nal.bytes.data(), nal.bytes.size());
  }
  return ~crc;
}

std::uint32_t textChecksum(std::string_view text) {
  return continuedChecksum(0, text);
}

std::uint32_t continuedChecksum(std::uint32_t checksum, std::string_view more) {
  return ~add(~checksum, reinterpret_cast<const std::uint8_t*>(more.data()), more.size());
}

}  // namespace cartvo::capture
