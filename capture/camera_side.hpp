#pragma once

#include <cstdint>

namespace cartvo {

enum class CameraSide : std::uint8_t { left, right };

}  // namespace cartvo
