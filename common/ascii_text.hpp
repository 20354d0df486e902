#pragma once

#include <string>
#include <string_view>

// Letters and blanks of ASCII text, as protocols and file formats define them, whatever the locale.

namespace cartvo {

/// The text with the letters A to Z, or a to z, exchanged for the others.
std::string lowerCase(std::string_view text);
std::string upperCase(std::string_view text);

/// The text without blanks, tabs and ends of lines at both of its ends. A view of `text`.
std::string_view trimmed(std::string_view text);

}  // namespace cartvo
