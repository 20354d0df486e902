#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

namespace cartvo::simulate {

/// One picture of an H.264 stream: the range of its bytes and its exposure.
struct AccessUnit {
  std::int64_t instant_ns = 0;  ///< exposure, ns since the content's start
  std::uint64_t begin = 0;      ///< first byte in EncodedStream::bytes
  std::uint64_t size = 0;       ///< bytes
  bool key_frame = false;       ///< an IDR picture, preceded by its parameter sets

  friend bool operator==(const AccessUnit&, const AccessUnit&) = default;
};

/// The H.264 byte stream (ITU-T H.264, annex B) of one camera.
struct EncodedStream {
  cv::Size size;            ///< of the pictures, px
  double frame_rate = 0.0;  ///< nominal, Hz
  /// One key-frame interval, repeated until the content starts. Instants: 0, one frame period, two periods
  /// ...
  std::vector<AccessUnit> lead_in;
  std::vector<AccessUnit> units;  ///< the content; the first is a key frame
  std::vector<std::uint8_t> bytes;

  /// The bytes of `unit`.
  std::span<const std::uint8_t> data(const AccessUnit& unit) const {
    return {bytes.data() + unit.begin, static_cast<std::size_t>(unit.size)};
  }

  friend bool operator==(const EncodedStream&, const EncodedStream&) = default;
};

/// The streams of both cameras.
struct EncodedPair {
  EncodedStream left;
  EncodedStream right;

  friend bool operator==(const EncodedPair&, const EncodedPair&) = default;
};

}  // namespace cartvo::simulate
