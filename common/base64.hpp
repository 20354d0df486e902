#pragma once

#include <optional>
#include <string>
#include <string_view>

// Base64 (RFC 4648), with padding and without line breaks.

namespace cartvo {

std::string encodeBase64(std::string_view bytes);

/// The bytes; nothing if the text is not base64.
std::optional<std::string> decodeBase64(std::string_view text);

}  // namespace cartvo
