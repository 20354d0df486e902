#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string>

namespace cartvo {

/// Appends an unsigned number, lowest byte first.
template <std::unsigned_integral Number>
void appendLittleEndian(std::string& bytes, Number number) {
  for (std::size_t i = 0; i < sizeof number; ++i)
    bytes += static_cast<char>(number >> (8 * i) & 0xffU);
}

/// Appends a double as in IEEE 754, lowest byte first.
inline void appendLittleEndian(std::string& bytes, double number) {
  appendLittleEndian(bytes, std::bit_cast<std::uint64_t>(number));
}

}  // namespace cartvo
