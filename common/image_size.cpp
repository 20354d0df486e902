// Image sizes as text, such as 680x420.
#include "common/image_size.hpp"

#include <charconv>
#include <cstddef>
#include <system_error>

namespace cartvo {
namespace {

/// Parses a side at the beginning of the text and removes it from there. 0 if the text does not begin with
/// one.
int parseSide(std::string_view& text) {
  constexpr std::ptrdiff_t kMaxDigits = 5;
  int side = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
  if (error != std::errc() || end - text.data() > kMaxDigits || text.front() == '0') return 0;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return side;
}

}  // namespace

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::optional<cv::Size> parseImageSize(std::string_view text) {
  const int width = parseSide(text);
  if (width <= 0 || !text.starts_with('x')) return std::nullopt;
  text.remove_prefix(1);
  const int height = parseSide(text);
  if (height <= 0 || !text.empty()) return std::nullopt;
  return cv::Size(width, height);
}

}  // namespace cartvo
