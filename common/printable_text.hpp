#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace cartvo {

/// Whether text can be displayed, logged, and written as YAML or JSON and read back unchanged: UTF-8 (RFC
/// 3629) without line breaks, terminal control characters and characters that reverse the direction of
/// writing.
bool isPrintable(std::string_view text);

/// The longest prefix of `text` of at most `max_bytes` bytes that ends between two UTF-8 characters. May be
/// empty if `text` is not UTF-8. A view of `text`.
std::string_view utf8Prefix(std::string_view text, std::size_t max_bytes);

/// Text from outside for messages: the first `max_bytes` bytes, then "..."; characters that are not printable
/// become
/// "\\xNN", one for each byte.
std::string printableExcerpt(std::string_view text, std::size_t max_bytes = 60);

}  // namespace cartvo
