// Builds messages in the wire format of Protocol Buffers.
#include "tools/export/mcap/protobuf_message.hpp"

#include "tools/export/mcap/little_endian.hpp"

namespace cartvo {
namespace {

constexpr std::uint32_t kVarint = 0, kFixed64 = 1, kLengthDelimited = 2;

}  // namespace

void ProtobufMessage::varint(std::uint64_t value) {
  for (; value > 0x7fU; value >>= 7U)
    bytes_ += static_cast<char>((value & 0x7fU) | 0x80U);
  bytes_ += static_cast<char>(value);
}

void ProtobufMessage::key(std::uint32_t field, std::uint32_t wire_type) {
  varint(field << 3U | wire_type);
}

ProtobufMessage& ProtobufMessage::number(std::uint32_t field, std::uint64_t value) {
  key(field, kVarint);
  varint(value);
  return *this;
}

ProtobufMessage& ProtobufMessage::real(std::uint32_t field, double value) {
  key(field, kFixed64);
  appendLittleEndian(bytes_, value);
  return *this;
}

ProtobufMessage& ProtobufMessage::reals(std::uint32_t field, std::span<const double> values) {
  key(field, kLengthDelimited);
  varint(values.size_bytes());
  for (const double value : values)
    appendLittleEndian(bytes_, value);
  return *this;
}

ProtobufMessage& ProtobufMessage::text(std::uint32_t field, std::string_view value) {
  key(field, kLengthDelimited);
  varint(value.size());
  bytes_ += value;
  return *this;
}

ProtobufMessage& ProtobufMessage::message(std::uint32_t field, const ProtobufMessage& value) {
  return text(field, value.bytes());
}

}  // namespace cartvo
