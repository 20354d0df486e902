#pragma once

#include <string>
#include <string_view>

namespace cartvo {

/// Orders names with numbers by their values: "frame2" before "frame10". Two names that are each one decimal
/// number ("1.25", "1.3") are ordered by that number. Names that differ only by leading zeros are ordered by
/// their characters, so that this is a total order.
struct NaturalOrder {
  bool operator()(std::string_view a, std::string_view b) const;
};

/// The name without the leading zeros of its numbers: "frame007" and "frame7" are the same name.
std::string withoutLeadingZeros(std::string_view name);

}  // namespace cartvo
