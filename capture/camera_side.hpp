#pragma once

#include <cstdint>

namespace cartvo::capture {

/// One of the two cameras of the stereo rig.
enum class CameraSide : std::uint8_t { left, right };

/// "left" or "right".
constexpr const char* sideName(CameraSide side) {
  return side == CameraSide::left ? "left" : "right";
}

}  // namespace cartvo::capture
