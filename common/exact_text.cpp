// Numbers as text that does not depend on the locale.
#include "common/exact_text.hpp"

#include <array>
#include <charconv>
#include <system_error>

namespace cartvo {
namespace {

std::string textOf(double value, std::chars_format format, int precision) {
  std::array<char, 400> text{};  // the longest double has 309 digits before the point
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value, format, precision);
  return error == std::errc() ? std::string(text.data(), end) : std::string();
}

}  // namespace

std::string exactText(double value) {
  constexpr int kMinDigits = 6, kMaxDigits = 17;
  for (int digits = kMinDigits; digits < kMaxDigits; ++digits) {
    std::string text = roundedText(value, digits);
    double read = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), read);
    if (read == value) return text;
  }
  return roundedText(value, kMaxDigits);
}

std::string exactText(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values)
    text += (text.size() > 1 ? ", " : "") + exactText(value);
  return text + "]";
}

std::string fixedText(double value, int decimals) {
  return textOf(value, std::chars_format::fixed, decimals);
}

std::string roundedText(double value, int digits) {
  return textOf(value, std::chars_format::general, digits);
}

}  // namespace cartvo
