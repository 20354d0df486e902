#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "capture/encoded_unit.hpp"

namespace cartvo::capture {

/// CRC-32 (IEEE 802.3) of a picture's NAL units without parameter sets and start codes. A container stores
/// those differently, so the checksum is the same before and after storage.
std::uint32_t pictureChecksum(VideoCodec codec, std::span<const std::uint8_t> unit);

/// CRC-32 (IEEE 802.3) of a text.
std::uint32_t textChecksum(std::string_view text);

/// CRC-32 of a text that begins with one of that `checksum` and continues with `more`; 0 for an empty one.
std::uint32_t continuedChecksum(std::uint32_t checksum, std::string_view more);

}  // namespace cartvo::capture
