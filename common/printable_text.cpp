// Check of UTF-8 text for printable characters, and truncation between characters.
#include "common/printable_text.hpp"

#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>

namespace cartvo {
namespace {

bool isContinuationByte(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

/// Decodes the UTF-8 character at the beginning of `text` and removes it from there. std::nullopt for invalid
/// bytes (RFC 3629: no overlong form, no surrogate, nothing above U+10FFFF).
std::optional<std::uint32_t> decodeCharacter(std::string_view& text) {
  struct Form {
    std::size_t length;
    std::uint32_t lead, mask, least;
  };
  static constexpr std::array<Form, 4> kForms{
      {{1, 0x00, 0x7F, 0}, {2, 0xC0, 0x1F, 0x80}, {3, 0xE0, 0x0F, 0x800}, {4, 0xF0, 0x07, 0x10000}}};
  const std::uint32_t first = static_cast<unsigned char>(text.front());
  for (const Form& form : kForms) {
    if ((first & ~form.mask) != form.lead) continue;
    if (text.size() < form.length) return std::nullopt;
    std::uint32_t character = first & form.mask;
    for (std::size_t i = 1; i < form.length; ++i) {
      if (!isContinuationByte(text[i])) return std::nullopt;
      character = character << 6U | (static_cast<unsigned char>(text[i]) & 0x3FU);
    }
    const bool is_surrogate = character >= 0xD800 && character <= 0xDFFF;
    if (character < form.least || is_surrogate || character > 0x10FFFF) return std::nullopt;
    text.remove_prefix(form.length);
    return character;
  }
  return std::nullopt;
}

/// Line breaks, terminal control characters and characters that reverse the direction of writing.
bool isControl(std::uint32_t character) {
  const auto within = [character](std::uint32_t first, std::uint32_t last) {
    return character >= first && character <= last;
  };
  return character < 0x20 || within(0x7F, 0x9F) || within(0x2028, 0x202E) || within(0x2066, 0x2069);
}

}  // namespace

bool isPrintable(std::string_view text) {
  while (!text.empty()) {
    const auto character = decodeCharacter(text);
    if (!character || isControl(*character)) return false;
  }
  return true;
}

std::string_view utf8Prefix(std::string_view text, std::size_t max_bytes) {
  if (text.size() <= max_bytes) return text;
  std::size_t end = max_bytes;
  while (end > 0 && isContinuationByte(text[end]))
    --end;
  return text.substr(0, end);
}

std::string printableExcerpt(std::string_view text, std::size_t max_bytes) {
  std::string_view rest = text.substr(0, max_bytes);
  // Text that is not UTF-8 throughout is cut anywhere.
  if (const std::string_view whole = utf8Prefix(text, max_bytes); isPrintable(whole)) rest = whole;
  const bool is_cut = rest.size() < text.size();
  std::string excerpt;
  while (!rest.empty()) {
    std::string_view after = rest;
    const auto character = decodeCharacter(after);
    const std::size_t length = character ? rest.size() - after.size() : 1;
    const std::string_view bytes = rest.substr(0, length);
    if (character && !isControl(*character)) {
      excerpt += bytes;
    } else {
      for (const char byte : bytes) {
        std::array<char, 8> escaped{};
        std::snprintf(escaped.data(), escaped.size(), "\\x%02x", static_cast<unsigned>(byte) & 0xFFU);
        excerpt += escaped.data();
      }
    }
    rest.remove_prefix(length);
  }
  return is_cut ? excerpt + "..." : excerpt;
}

}  // namespace cartvo
