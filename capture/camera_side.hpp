#pragma once

#include <cstdint>

namespace cartvo::capture {

/// One of the two cameras of the stereo rig.
enum class CameraSide : std::uint8_t { left, right };

}  // namespace cartvo::capture
