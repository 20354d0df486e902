#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

namespace cartvo::simulate {

/// One picture of an H.264 stream: where its bytes lie and when it was exposed.
struct AccessUnit {
  std::int64_t instant_ns = 0;  ///< of exposure, since the content's start
  std::uint64_t begin = 0;      ///< first byte in EncodedStream::bytes
  std::uint64_t size = 0;       ///< bytes
  bool key_frame = false;       ///< an IDR picture with its parameter sets before it

  friend bool operator==(const AccessUnit&, const AccessUnit&) = default;
};

/// One camera's pictures as the H.264 byte stream (ITU-T H.264, annex B) that it sends.
struct EncodedStream {
  cv::Size size;            ///< of the pictures, px
  double frame_rate = 0.0;  ///< nominal, Hz
  /// What is shown until the content begins, one key-frame interval long, again and again.
  /// Instants: from 0, a frame period apart.
  std::vector<AccessUnit> lead_in;
  std::vector<AccessUnit> units;  ///< the content; the first is a key frame
  std::vector<std::uint8_t> bytes;

  std::span<const std::uint8_t> data(const AccessUnit& unit) const {
    return {bytes.data() + unit.begin, static_cast<std::size_t>(unit.size)};
  }

  friend bool operator==(const EncodedStream&, const EncodedStream&) = default;
};

/// What the two cameras send.
struct EncodedPair {
  EncodedStream left;
  EncodedStream right;

  friend bool operator==(const EncodedPair&, const EncodedPair&) = default;
};

}  // namespace cartvo::simulate
