#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace cartvo {

/// A digest of 64 bits that tells damage and other content, but no intent. Fowler, Noll, Vo: FNV-1a, eight
/// bytes at a time, with the upper half of each product mixed into the lower one, because a product carries
/// upwards only.
class Digest {
 public:
  void add(std::uint64_t eight) {
    value_ = (value_ ^ eight) * 1099511628211U;
    value_ ^= value_ >> 32;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037U;
};

/// The first `count` bytes, at most eight; the others are zero.
inline std::uint64_t eightBytes(const void* bytes, std::size_t count) {
  std::uint64_t eight = 0;
  std::memcpy(&eight, bytes, count);
  return eight;
}

inline std::uint64_t digestOf(std::string_view bytes) {
  Digest digest;
  digest.add(bytes.size());
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(std::uint64_t))
    digest.add(eightBytes(bytes.data() + i, std::min(sizeof(std::uint64_t), bytes.size() - i)));
  return digest.value();
}

}  // namespace cartvo
