#pragma once

#include <cstdint>

#include "capture/frame.hpp"
#include "tests/support/capture/encoded_sequence.hpp"

namespace cartvo::test {

/// Attributes by which frames are compared.
struct FrameDigest {
  std::uint64_t sequence;
  std::int64_t exposure_ns;
  std::int64_t arrival_ns;
  capture::InstantSource source;
  capture::FrameStatus status;
  std::uint64_t pixels;  ///< hash
  bool operator==(const FrameDigest&) const = default;
};

inline FrameDigest digestOf(const capture::Frame& frame) {
  return {frame.sequence,       frame.exposure_ns, frame.arrival_ns,
          frame.instant_source, frame.status,      digest(frame.image)};
}

}  // namespace cartvo::test
