#pragma once

#include <cstdint>
#include <string>

namespace cartvo {

/// A number with its noun: "1 pair", "2 pairs".
inline std::string counted(std::uint64_t number, const std::string& noun) {
  return std::to_string(number) + " " + noun + (number == 1 ? "" : "s");
}

}  // namespace cartvo
