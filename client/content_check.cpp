// Check sum of an odometry message. Its own code, because a controller links nothing but LCM.

#include <array>

#include <cartvo/client.hpp>

namespace cartvo::client {
namespace {

using Table = std::array<std::uint32_t, 256>;

constexpr Table crcTable() {
  Table table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t value = byte;
    for (int bit = 0; bit < 8; ++bit)
      value = (value >> 1) ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
    table[byte] = value;
  }
  return table;
}

constexpr Table kTable = crcTable();
constexpr int kMostBytes = 2048;  // a message of this type has fewer

}  // namespace

std::int32_t contentCrc(const odometry_t& message) {
  std::array<std::uint8_t, kMostBytes> bytes{};
  const int size = message.encode(bytes.data(), 0, kMostBytes) - static_cast<int>(sizeof(message.crc32));
  std::uint32_t crc = ~0U;
  for (int i = 0; i < size; ++i)
    crc = (crc >> 8) ^ kTable[(crc ^ bytes[static_cast<std::size_t>(i)]) & 0xFFU];
  return static_cast<std::int32_t>(~crc);
}

bool isIntact(const odometry_t& message) {
  return message.crc32 == contentCrc(message);
}

}  // namespace cartvo::client
