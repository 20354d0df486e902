#include "calib/image_size.hpp"

#include <charconv>
#include <cstddef>
#include <system_error>

namespace cartvo {
namespace {

/// Takes a side off the text; 0 if it does not begin with one.
int takeSide(std::string_view& text) {
  constexpr std::ptrdiff_t kMostDigits = 5;
  int side = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
  if (error != std::errc() || end - text.data() > kMostDigits || text.front() == '0') return 0;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return side;
}

}  // namespace

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::optional<cv::Size> sizeFrom(std::string_view text) {
  const int width = takeSide(text);
  if (width <= 0 || !text.starts_with('x')) return std::nullopt;
  text.remove_prefix(1);
  const int height = takeSide(text);
  if (height <= 0 || !text.empty()) return std::nullopt;
  return cv::Size(width, height);
}

}  // namespace cartvo
