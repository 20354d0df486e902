#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace cartvo {

/// Builds one message in the wire format of Protocol Buffers.
class ProtobufMessage {
 public:
  ProtobufMessage& number(std::uint32_t field, std::uint64_t value);
  ProtobufMessage& real(std::uint32_t field, double value);
  ProtobufMessage& reals(std::uint32_t field, std::span<const double> values);  ///< packed
  ProtobufMessage& text(std::uint32_t field, std::string_view value);           ///< string or bytes
  ProtobufMessage& message(std::uint32_t field, const ProtobufMessage& value);

  const std::string& bytes() const { return bytes_; }

 private:
  void varint(std::uint64_t value);
  void key(std::uint32_t field, std::uint32_t wire_type);

  std::string bytes_;
};

}  // namespace cartvo
