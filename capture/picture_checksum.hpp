#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "capture/encoded_unit.hpp"

namespace cartvo {

/// CRC-32 (IEEE 802.3) of a picture's NAL units but for parameter sets and start codes, which a container
/// stores elsewhere or otherwise: the same before and after it.
std::uint32_t pictureChecksum(VideoCodec codec, std::span<const std::uint8_t> unit);

/// CRC-32 (IEEE 802.3) of a text.
std::uint32_t textChecksum(std::string_view text);

}  // namespace cartvo
