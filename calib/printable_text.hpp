#pragma once

#include <cstddef>
#include <string_view>

// Text of others in UTF-8, as it may be shown to people.

namespace cartvo {

/// Whether a text can be shown, logged, written as YAML or JSON and read back the same: UTF-8 (RFC 3629)
/// without characters that end a line, steer a terminal or turn the direction of writing around.
bool isPrintable(std::string_view text);

/// The text's beginning, at most so many bytes of it, cut between two characters; of bytes that are not
/// UTF-8 perhaps nothing. A view of `text`.
std::string_view beginningOf(std::string_view text, std::size_t most_bytes);

}  // namespace cartvo
