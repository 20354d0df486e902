#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "capture/frame.hpp"

namespace cartvo {

enum class CameraSide : std::uint8_t { left, right };

/// A left and a right frame that belong together.
struct FramePair {
  Frame left;
  Frame right;

  /// Right minus left exposure, ns. The cameras run free, so it is rarely zero.
  std::int64_t offset_ns() const { return right.exposure_ns - left.exposure_ns; }
};

}  // namespace cartvo
